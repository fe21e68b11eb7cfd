"""The packing arm's driver: Eq. 4, interpolation, watchdog, refusals."""

import numpy as np
import pytest

from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.robots.panda import PANDA
from pack_sim.brakes import BRAKE_TIME, LATE_BRAKE_TIME, SLOW_DOWN, TorqueBrake
from unit.pack_sim.packing.driver import Driver

HOME = np.array(packing_cell().robot.home)
ZERO = np.zeros(7)


def M() -> np.ndarray:
    return np.diag([1.5, 2.5, 1.5, 1.2, 0.2, 0.2, 0.1])


@pytest.fixture
def controller() -> Driver:
    return Driver(packing_cell().robot, watchdog=0.1)


def setpoints(q=HOME, v=ZERO, tau=ZERO, rows: int = 3, time: float = 0.0) -> Setpoints:
    return Setpoints(time, 0.1 * np.arange(rows), *(np.tile(x, (rows, 1)) for x in (q, v, tau)))


def test_torque_is_feed_forward_plus_stiffness_and_damping(controller: Driver) -> None:
    v_d, tau_ff = np.full(7, 0.1), np.full(7, 0.5)
    controller.accept(setpoints(HOME + 0.02, v_d, tau_ff), 0.0)
    robot = packing_cell().robot
    expected = 0.5 + np.array(robot.stiffness) * 0.02 + np.array(robot.damping) * (0.1 - 0.03)
    np.testing.assert_allclose(controller.torque(0.05, HOME, np.full(7, 0.03), M), expected)


def test_the_papers_gains_are_configured() -> None:
    robot = packing_cell().robot
    assert robot.stiffness == (100, 100, 100, 100, 100, 60, 60)
    assert robot.damping == (75, 75, 75, 75, 20, 12, 12)


def test_torque_stays_within_the_limits(controller: Driver) -> None:
    controller.accept(setpoints(tau=PANDA.limits.effort), 0.0)
    assert np.all(controller.torque(0.01, HOME - 1.0, -PANDA.limits.velocity, M) == PANDA.limits.effort)


def test_torque_changes_no_faster_than_its_rate_while_setpoints_are_tracked() -> None:
    controller = Driver(packing_cell().robot, watchdog=0.1, torque_step=1.0)
    controller.accept(setpoints(tau=np.full(7, 3.5)), 0.0)
    torques = [controller.torque(0.001 * i, HOME, ZERO, M) for i in range(5)]
    np.testing.assert_allclose(torques, np.outer([1.0, 2.0, 3.0, 3.5, 3.5], np.ones(7)))


def test_a_stop_is_not_made_slower_by_the_bound_on_the_rate() -> None:
    controller = Driver(packing_cell().robot, watchdog=0.1, torque_step=1.0)
    v = np.full(7, 0.1)
    np.testing.assert_allclose(controller.torque(0.0, HOME, v, M), -(M() @ v) / BRAKE_TIME)


@pytest.mark.parametrize(
    ("is_touching", "is_late", "brake_time"),
    [(False, True, LATE_BRAKE_TIME), (True, True, BRAKE_TIME), (False, False, BRAKE_TIME)],
)
def test_a_stop_is_gentle_only_if_setpoints_are_merely_late_and_nothing_is_touched(
    is_touching: bool, is_late: bool, brake_time: float
) -> None:
    brake, v = TorqueBrake(PANDA.limits, M, lambda: is_touching), np.full(7, 0.1)
    np.testing.assert_allclose(brake.hold(0.0, HOME, v, is_late=is_late)[2], -(M() @ v) / brake_time)


def test_what_a_stop_itself_exerts_is_no_contact() -> None:
    touches = iter([False, True])
    brake, v = TorqueBrake(PANDA.limits, M, lambda: next(touches)), np.full(7, 0.1)
    first, second = (brake.hold(time, HOME, v, is_late=True)[2] for time in (0.0, 0.001))
    np.testing.assert_array_equal(first, second)


def test_setpoints_are_interpolated_between_rows(controller: Driver) -> None:
    plan = setpoints(rows=2, time=1.0)
    plan.q[1] += 0.1
    controller.accept(plan, 1.0)
    np.testing.assert_allclose(controller.reference(1.025, HOME, ZERO, M)[0], HOME + 0.025)
    np.testing.assert_allclose(controller.reference(0.99, HOME, ZERO, M)[0], HOME)


def test_setpoints_that_come_early_wait_for_their_time_while_those_before_go_on(
    controller: Driver,
) -> None:
    controller.accept(setpoints(HOME), 0.0)
    controller.accept(setpoints(HOME + 0.1, time=0.03), 0.01)
    for time, expected in ((0.01, HOME), (0.029, HOME), (0.03, HOME + 0.1), (0.05, HOME + 0.1)):
        np.testing.assert_allclose(controller.reference(time, HOME, ZERO, M)[0], expected)


def test_early_setpoints_wait_no_longer_than_until_others_come(controller: Driver) -> None:
    controller.accept(setpoints(HOME), 0.0)
    controller.accept(setpoints(HOME + 0.1, time=0.06), 0.01)
    controller.accept(setpoints(HOME + 0.2, time=0.07), 0.02)
    np.testing.assert_allclose(controller.reference(0.021, HOME, ZERO, M)[0], HOME + 0.1)
    np.testing.assert_allclose(controller.reference(0.071, HOME, ZERO, M)[0], HOME + 0.2)


def test_setpoints_of_the_past_end_those_that_wait(controller: Driver) -> None:
    controller.accept(setpoints(HOME), 0.0)
    controller.accept(setpoints(HOME + 0.1, time=0.03), 0.01)
    controller.accept(setpoints(HOME, rows=1), 0.02)  # a hold: over when it comes
    controller.reference(0.04, HOME, ZERO, M)
    assert controller.is_holding


def test_without_setpoints_the_arm_is_held_where_it_was_first_seen(controller: Driver) -> None:
    controller.torque(0.0, HOME, ZERO, M)
    tau = controller.torque(0.5, HOME + 0.01, ZERO, M)
    np.testing.assert_allclose(tau, -0.01 * np.array(packing_cell().robot.stiffness))
    assert controller.is_holding


def test_stale_setpoints_are_not_followed(controller: Driver) -> None:
    controller.accept(setpoints(HOME + 0.2, rows=20), 0.0)
    controller.torque(0.099 + SLOW_DOWN, HOME, ZERO, M)
    assert not controller.is_holding
    q_d, v_d, tau_ff = controller.reference(0.101 + SLOW_DOWN, HOME, ZERO, M)
    assert controller.is_holding
    np.testing.assert_array_equal(np.stack([q_d, v_d, tau_ff]), [HOME, ZERO, ZERO])


def test_setpoints_that_ran_out_are_not_followed(controller: Driver) -> None:
    controller.accept(setpoints(rows=1), 0.0)
    controller.torque(0.001, HOME, ZERO, M)
    assert controller.is_holding


def test_fresh_setpoints_end_a_hold(controller: Driver) -> None:
    controller.torque(0.0, HOME, ZERO, M)
    controller.accept(setpoints(time=0.5), 0.5)
    controller.torque(0.51, HOME, ZERO, M)
    assert not controller.is_holding


def test_a_moving_arm_is_braked_against_its_inertia_and_then_held_where_it_stopped(
    controller: Driver,
) -> None:
    v = np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0, -0.2])
    tau = controller.torque(0.0, HOME, v, M)
    np.testing.assert_allclose(tau, -M() @ v / BRAKE_TIME)
    assert controller.is_holding
    np.testing.assert_allclose(controller.torque(0.02, HOME + 0.01, ZERO, M), ZERO)
    tau = controller.torque(0.5, HOME + 0.02, v, M)
    robot = packing_cell().robot
    np.testing.assert_allclose(tau, -0.01 * np.array(robot.stiffness) - np.array(robot.damping) * v)


def test_dropped_setpoints_are_not_followed(controller: Driver) -> None:
    controller.accept(setpoints(HOME + 0.2), 0.0)
    controller.drop()
    controller.torque(0.01, HOME, ZERO, M)
    assert controller.is_holding


NAN_ROW = np.array([0, 0, np.nan, 0, 0, 0, 0.0])


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (setpoints(HOME + NAN_ROW), "a position is not finite"),
        (setpoints(v=NAN_ROW), "a velocity is not finite"),
        (setpoints(tau=NAN_ROW), "a torque is not finite"),
        (
            setpoints(PANDA.limits.upper + 0.1),
            "position of panda_joint1 is 2.997 rad; allowed: -2.897 to 2.897",
        ),
        (setpoints(PANDA.limits.lower - 0.1), "position of panda_joint1"),
        (setpoints(v=2 * PANDA.limits.velocity), "velocity of panda_joint1"),
        (setpoints(tau=-1.5 * PANDA.limits.effort), "torque of panda_joint1"),
        (
            Setpoints(0.0, np.zeros(1), np.zeros((1, 6)), np.zeros((1, 7)), np.zeros((1, 7))),
            r"shape \(1, 6\)",
        ),
        (Setpoints(0.0, np.zeros(1), HOME[None], ZERO[None], a=ZERO[None]), "tau has shape None"),
        (Setpoints(0.0, np.zeros(0), *3 * (np.zeros((0, 7)),)), "at least one"),
        (setpoints(time=9.0), r"begin 8.990 s ahead of the driver's time 0.010 s; allowed: 1.000 s"),
        (Setpoints(0.0, np.array([0.0, 0.0]), *3 * (np.tile(HOME, (2, 1)),)), "rise"),
        (Setpoints(0.0, np.array([0.0, np.nan]), *3 * (np.tile(HOME, (2, 1)),)), "rise"),
    ],
)
def test_bad_setpoints_are_refused_with_the_reason_and_change_nothing(controller, bad, reason) -> None:
    controller.accept(setpoints(HOME + 0.1), 0.0)
    before = controller.torque(0.01, HOME, ZERO, M)
    with pytest.raises(MessageError, match=reason):
        controller.accept(bad, 0.01)
    np.testing.assert_array_equal(controller.torque(0.01, HOME, ZERO, M), before)
