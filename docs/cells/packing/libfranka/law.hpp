// The law of a driver of the packing cell's arm, Eq. 4, for any torque interface (docs/cells/packing/driver.md).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

using Joints = std::array<double, 7>;

template <class T>
class Newest {  // triple buffer: one writer and one reader, neither ever waits for the other
 public:
  T& writable() { return slots_[back_]; }
  void publish() { back_ = middle_.exchange(back_ | 4, std::memory_order_acq_rel) & 3; }
  const T& read() {
    if (middle_.load(std::memory_order_acquire) & 4)  // 4: written since it was read last
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & 3;
    return slots_[front_];
  }

 private:
  std::array<T, 3> slots_{};
  std::atomic<int> middle_{1};
  int back_ = 0, front_ = 2;
};

struct Plan {  // checked by whoever writes it: names, sizes, finite, rising, limits, stamp
  double time = 0.0, received = -1e9;
  int rows = 0;
  std::array<double, 128> offset{};
  std::array<Joints, 128> q{}, v{}, tau{};
};

class Law {
 public:
  Joints kp{100, 100, 100, 100, 100, 60, 60}, kd{75, 75, 75, 75, 20, 12, 12};  // [N m/rad], [N m s/rad]
  double feedback = 1.0;     // robot.feedback
  double watchdog = 0.1;     // [s]
  double slow_down = 0.06;   // along overdue setpoints [s]
  double brake_time = 0.02;  // [s]

  // Torque without gravity. mass: joint inertias, the diagonal of the mass matrix.
  Joints torque(const Plan& newest, double now, const Joints& q, const Joints& v, const Joints& mass) {
    if (newest.rows > 0 && newest.received != received_) {  // the one that waited waits no longer
      if (next_.rows > 0) plan_ = next_;
      next_ = newest;
      received_ = newest.received;
    }
    if (next_.rows > 0 && now >= next_.time - 1e-6) {  // 1e-6: rounding
      plan_ = next_;
      next_.rows = 0;
    }
    const Plan& plan = plan_;
    Joints tau{};
    const double overdue = std::max(0.0, now - received_ - watchdog);
    const bool is_followed = plan.rows > 0 && overdue <= slow_down &&
                             now <= plan.time + plan.offset[plan.rows - 1];
    if (is_followed) {
      is_held_ = false;
      const double pace = 1 - overdue / slow_down;
      const double offset = now - 0.5 * overdue * overdue / slow_down - plan.time;
      int i = 0;
      while (i + 1 < plan.rows && plan.offset[i + 1] <= offset) ++i;
      const int j = std::min(i + 1, plan.rows - 1);
      const double span = plan.offset[j] - plan.offset[i];
      const double s = span > 0 ? std::clamp((offset - plan.offset[i]) / span, 0.0, 1.0) : 0.0;
      auto at = [&](const std::array<Joints, 128>& rows, int k) {
        return (1 - s) * rows[i][k] + s * rows[j][k];
      };
      for (int k = 0; k < 7; ++k) {
        const double behind = at(plan.q, k) - q[k], slower = pace * at(plan.v, k) - v[k];
        tau[k] = at(plan.tau, k) + feedback * (kp[k] * behind + kd[k] * slower);
      }
      return tau;
    }
    const bool is_moving = std::any_of(v.begin(), v.end(), [](double x) { return std::abs(x) > 0.01; });
    if (!is_held_ && is_moving) {
      for (int k = 0; k < 7; ++k) tau[k] = -mass[k] * v[k] / brake_time;
      return tau;
    }
    if (!is_held_) q_hold_ = q;
    is_held_ = true;
    for (int k = 0; k < 7; ++k) tau[k] = kp[k] * (q_hold_[k] - q[k]) - kd[k] * v[k];
    return tau;
  }

 private:
  Plan plan_, next_;  // in force; waiting for its time
  double received_ = -1e9;
  bool is_held_ = false;
  Joints q_hold_{};
};
