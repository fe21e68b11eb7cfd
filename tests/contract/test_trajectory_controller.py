"""What a joint trajectory controller does by its manual, of the one that the tests drive arms with."""

from __future__ import annotations

import numpy as np
import pytest

from foreign_driver.joint_trajectory_controller import (
    GOAL_TOLERANCE_VIOLATED,
    PATH_TOLERANCE_VIOLATED,
    JointTrajectoryController,
    Outcome,
    Rejected,
    Spline,
    Tolerances,
    Waypoint,
)
from pack_core.rotations import Array

H = 0.001


def row(*values: float) -> Array:
    return np.array(values)


def controller(path: float = 0.0, goal: float = 0.0, goal_time: float = 0.0) -> JointTrajectoryController:
    made = JointTrajectoryController(1, Tolerances(row(path), row(goal), goal_time))
    made.begin(0.0, row(0.0), row(0.0))
    return made


def run(made: JointTrajectoryController, until: float, off: float = 0.0) -> Array:
    """Cycles in which the joint is where it is told, or `off` from there; positions told."""
    told = []
    assert made.state is not None
    for k in range(round(made.state.time / H) + 1, round(until / H) + 1):
        q = made.state.reference[0] + off
        told.append(made.update(k * H, q, row(0.0))[0][0])
    return np.array(told)


def through(*points: tuple[float, float]) -> tuple[Waypoint, ...]:
    return tuple(Waypoint(time, row(q), row(0.0)) for time, q in points)


@pytest.mark.parametrize("degree", [1, 3, 5])
def test_splines_are_linear_cubic_or_quintic_by_what_both_points_hold(degree: int) -> None:
    """A polynomial of the spline's degree is found again from its ends, with its derivatives."""
    polynomial = np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0, -0.7, 0.4][: degree + 1])
    start, end = 0.2, 0.9

    def waypoint(t: float) -> Waypoint:
        v, a = (row(polynomial.deriv(k)(t)) for k in (1, 2))
        return Waypoint(t, row(polynomial(t)), v if degree > 1 else None, a if degree > 3 else None)

    spline = Spline(waypoint(start), waypoint(end))
    for t in np.linspace(start, end, 7):
        expected = [polynomial(t), *(polynomial.deriv(k)(t) for k in (1, 2) if k <= degree)]
        np.testing.assert_allclose(np.ravel(spline.at(t))[: len(expected)], expected, atol=1e-9)


def test_a_trajectory_is_followed_to_its_end_and_held_there() -> None:
    made = controller()
    goal = made.follow(through((1.0, 0.5)), 0.0, None)
    told = run(made, 1.5)
    assert told[499] == pytest.approx(0.25, abs=1e-2)
    assert np.all(told[1000:] == 0.5)
    assert goal.outcome is Outcome.SUCCEEDED


def test_a_new_goal_aborts_the_one_before_and_is_taken_up_in_the_middle() -> None:
    made = controller()
    first = made.follow(through((0.0, 0.0), (1.0, 1.0)), 0.0, None)
    before = run(made, 0.5)[-1]
    second = made.follow(through((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)), 0.001, None)
    after = run(made, 0.51)
    assert first.outcome is Outcome.ABORTED
    assert second.outcome is None
    assert np.abs(np.diff([before, *after])).max() < 2e-3


def test_a_joint_off_its_path_ends_the_goal_and_is_held_where_it_is() -> None:
    made = controller(path=0.01)
    goal = made.follow(through((1.0, 0.5)), 0.0, None)
    run(made, 0.3, off=0.005)
    assert goal.outcome is None
    told = run(made, 0.4, off=0.02)
    assert (goal.outcome, goal.error_code) == (Outcome.ABORTED, PATH_TOLERANCE_VIOLATED)
    # The hold begins at the measured position, 0.02 from what was asked for.
    assert told[3] - told[0] == pytest.approx(0.02, abs=2e-3)


def test_a_joint_off_its_goal_has_the_goal_time_to_come_there() -> None:
    made = controller()
    tolerances = Tolerances(row(0.0), row(0.01), 0.2)
    goal = made.follow(through((1.0, 0.5)), 0.0, tolerances)
    run(made, 1.15, off=0.02)
    assert goal.outcome is None
    run(made, 1.25, off=0.02)
    assert (goal.outcome, goal.error_code) == (Outcome.ABORTED, GOAL_TOLERANCE_VIOLATED)


def test_scaling_slows_the_trajectory_s_own_time_and_zero_is_a_pause() -> None:
    made = controller()
    goal = made.follow(through((1.0, 1.0)), 0.0, None)
    run(made, 0.5)
    made.speed = 0.0
    paused = run(made, 2.0)
    assert np.all(paused[-1000:] == paused[-1])
    assert goal.outcome is None
    made.speed = 1.0
    assert run(made, 3.0)[-1] == 1.0
    assert goal.outcome is Outcome.SUCCEEDED


def test_after_a_stop_nothing_moves_until_there_is_another_trajectory() -> None:
    made = controller()
    goal = made.follow(through((1.0, 0.5)), 0.0, None)
    run(made, 0.5)
    made.stop()
    stopped = run(made, 1.5)
    assert np.ptp(stopped[-500:]) == 0.0
    assert goal.outcome is Outcome.ABORTED
    with pytest.raises(Rejected, match="stopped"):
        made.follow(through((1.0, 0.5)), 0.0, None)
    made.release()
    assert np.ptp(run(made, 2.0)) == 0.0


def test_efforts_are_fed_forward_linearly_and_end_with_the_command_timeout() -> None:
    made = controller()
    made.drives_effort = made.may_end_moving = True
    made.command_timeout = 0.1
    made.take((Waypoint(0.0, row(0.0), row(0.1), effort=row(2.0)),
               Waypoint(0.2, row(0.02), row(0.1), effort=row(6.0))), 0.0)  # fmt: skip
    efforts = [made.update(k * H, row(0.01), row(0.0))[2][0] for k in range(1, 400)]
    assert efforts[99] == pytest.approx(4.0)
    assert efforts[250] == 6.0, "after its end the last point stands as it is"
    assert (efforts[350], made.state.reference[0][0]) == (0.0, 0.01), "then the arm is held where it is"


def test_a_trajectory_is_joined_from_what_was_desired_last_where_that_is_set() -> None:
    for joins in (False, True):
        made = controller()
        made.interpolates_from_desired = joins
        made.take(through((0.1, 0.2), (0.3, 0.2)), 0.0)
        run(made, 0.2)
        made.take(through((0.1, 0.5)), 0.0)
        first = made.update(0.201, row(0.15), row(0.0))[0][0]
        assert first == pytest.approx(0.2 if joins else 0.15, abs=1e-3)


@pytest.mark.parametrize(
    ("points", "stamp", "why"),
    [
        ((), 0.0, "without points"),
        (through((0.5, 0.1), (0.5, 0.2)), 0.0, "do not rise"),
        ((Waypoint(1.0, row(0.1, 0.2)),), 0.0, "another size"),
        (through((0.1, 0.1)), 0.5, "in the past"),
        ((Waypoint(1.0, row(0.1), row(0.3)),), 0.0, "last velocity"),
    ],
)
def test_what_cannot_be_followed_is_rejected(points: tuple[Waypoint, ...], stamp: float, why: str) -> None:
    made = controller()
    run(made, 1.0)
    with pytest.raises(Rejected, match=why):
        made.follow(points, stamp, None)
