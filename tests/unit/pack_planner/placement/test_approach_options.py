"""Which ways in are tried."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pack_core.rotations import Pose
from pack_planner.placement.approach_options import FARTHEST, beside, random_ways, steeper
from pack_planner.placement.placement_result import PlacementCandidate

ANYWHERE = [PlacementCandidate(Pose(np.array([0.5, y, 0.09])), ("box",), 0.0) for y in (-0.05, 0.05)]


@given(st.floats(0.0, 1.57))
def test_a_steeper_tilt_is_steeper_and_never_flat(lean: float) -> None:
    assert lean <= steeper(lean) < 0.5 * math.pi


@given(st.floats(0.0, 1.5), st.integers(1, 50), st.integers(0, 1000))
def test_random_ways_lean_at_least_as_far_and_begin_within_reach(lean: float, count: int, seed: int) -> None:
    options = random_ways(ANYWHERE, lean, count, np.random.default_rng(seed))
    assert len(options) == count
    for option in options:
        np.testing.assert_allclose(np.linalg.norm(option.way.over), 1.0)
        assert option.way.lean in (lean, steeper(lean))
        assert option.way.back is not None
        assert 0.0 <= option.way.back <= FARTHEST


def test_beside_two_facing_obstacles_there_is_no_side() -> None:
    poses = {"a": Pose(np.array([0.45, 0.0, 0.06])), "b": Pose(np.array([0.55, 0.0, 0.06]))}
    between = PlacementCandidate(Pose(np.array([0.5, 0.0, 0.09])), ("a", "b"), 0.0)
    np.testing.assert_array_equal(beside(between, poses, 0.4).way.over, 0.0)
