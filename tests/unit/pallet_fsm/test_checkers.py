import numpy as np
import pytest

from pack_core.rotations import Pose, exp
from pallet_fsm.checkers import TargetChecker
from pallet_fsm.states import Check

GOAL = Pose(np.array([1.0, 2.0, 0.5]))


def at(distance: float, angle_deg: float) -> Pose:
    return Pose(GOAL.p + distance * np.array([0.0, 1.0, 0.0]), exp(np.deg2rad([0.0, 0.0, angle_deg])))


@pytest.mark.parametrize(
    ("distance", "angle", "is_there"),
    [(0.0019, 0.49, True), (0.0021, 0.0, False), (0.0, 0.51, False)],
)
def test_precise_targets_are_reached_within_2_mm_and_half_a_degree(distance, angle, is_there) -> None:
    assert TargetChecker(GOAL, Check.PRECISE).look(at(distance, angle)) is is_there


def test_transit_targets_need_three_looks_in_a_row_within_5_mm_and_1_degree() -> None:
    checker = TargetChecker(GOAL, Check.TRANSIT)
    looks = [at(0.004, 0.9), at(0.004, 0.9), at(0.006, 0.0), at(0.0, 0.0), at(0.0, 0.0), at(0.0, 0.0)]
    assert [checker.look(X_WT) for X_WT in looks] == [False, False, False, False, False, True]
