// The arm's thread of a driver with libfranka; others subscribe to setpoints and publish what is measured.
#include <franka/model.h>
#include <franka/rate_limiting.h>
#include <franka/robot.h>

#include "law.hpp"

void drive(franka::Robot& robot, Newest<Plan>& plans, Newest<franka::RobotState>& states, double (*clock)()) {
  const Joints limit{87, 87, 87, 87, 12, 12, 12};
  const franka::Model model = robot.loadModel();
  Law law;
  robot.control([&](const franka::RobotState& state, franka::Duration) -> franka::Torques {
    states.writable() = state;  // a thread of its own publishes it at 500 Hz
    states.publish();
    const auto M = model.mass(state);
    Joints mass;
    for (int k = 0; k < 7; ++k) mass[k] = M[8 * k];  // diagonal of a 7 x 7 matrix
    Joints tau = law.torque(plans.read(), clock(), state.q, state.dq, mass);
    // The robot adds gravity and friction itself, and tau_ff holds the Coriolis terms of the planned motion.
    for (int k = 0; k < 7; ++k) tau[k] = std::clamp(tau[k], -limit[k], limit[k]);
    return franka::limitRate(franka::kMaxTorqueRate, tau, state.tau_J_d);
  });
}
