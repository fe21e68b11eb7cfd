import numpy as np
import pytest

from pack_core.rotations import Pose, exp
from pallet_fsm.leg_runner import SPEED_WINDOW, TargetChecker, ToolSpeed
from pallet_fsm.states import Check

GOAL = Pose(np.array([1.0, 2.0, 0.5]))


def at(distance: float, angle_deg: float) -> Pose:
    return Pose(GOAL.p + distance * np.array([0.0, 1.0, 0.0]), exp(np.deg2rad([0.0, 0.0, angle_deg])))


@pytest.mark.parametrize(
    ("distance", "angle", "is_there"),
    [(0.0019, 0.49, True), (0.0021, 0.0, False), (0.0, 0.51, False)],
)
def test_precise_targets_are_reached_within_2_mm_and_half_a_degree(distance, angle, is_there) -> None:
    assert TargetChecker(GOAL, Check.PRECISE).note(at(distance, angle)) is is_there


def test_transit_targets_need_three_looks_in_a_row_within_5_mm_and_1_degree() -> None:
    checker = TargetChecker(GOAL, Check.TRANSIT)
    looks = [at(0.004, 0.9), at(0.004, 0.9), at(0.006, 0.0), at(0.0, 0.0), at(0.0, 0.0), at(0.0, 0.0)]
    assert [checker.note(X_WT) for X_WT in looks] == [False, False, False, False, False, True]


@pytest.mark.parametrize("period", [0.004, 0.008, 0.03])
def test_the_speed_of_a_steady_tool_is_exact_once_there_are_measurements_far_enough_apart(
    period: float,
) -> None:
    speed, v = ToolSpeed(), np.array([0.003, 0.0, -0.004])
    for k in range(1 + int(np.ceil(SPEED_WINDOW / period))):
        assert speed.value == np.inf
        speed.note(7.0 + k * period, 0.5 + k * period * v)
    assert speed.value == pytest.approx(0.005)


def test_a_tool_that_stopped_has_no_speed_after_the_window() -> None:
    speed = ToolSpeed()
    for time in np.arange(0.0, 0.2, 0.004):
        speed.note(time, np.array([0.0, 0.0, min(time, 0.1)]))
        if time > 0.1 + SPEED_WINDOW + 0.004:
            assert speed.value == 0.0
    assert speed.value == 0.0
