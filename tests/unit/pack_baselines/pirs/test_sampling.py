"""Poses of the roadmap: inside the workspace, clear of what stays, spread as stated, repeatable."""

import numpy as np
import numpy.typing as npt
import pytest

from pack_baselines.pirs.geometry import Sizes, block_hits, is_inside
from pack_baselines.pirs.roadmap import (
    GOAL_SHARE,
    Way,
    draw_on_line,
    draw_pose,
    sample_clear_pose,
    sample_nodes,
    way_hits,
)
from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER
from pack_planner.rearrangement.footprints import edges, outlines

SIDE = 0.0508
SHAPE = np.array([SIDE, SIDE, 0.0])
SIZES = Sizes.of(SHAPE, GripperFootprint())
CORNERS = np.array([[0.2, -0.4], [1.0, -0.4], [1.0, 0.4], [0.2, 0.4]])
HALF_PLANES = edges(tuple(map(tuple, CORNERS.tolist())))
START, END = np.array([0.4, -0.1, 0.3]), np.array([0.8, 0.1, -0.2])
NONE = np.zeros((0, 6))
NO_WAY = Way(np.empty((1, 3)), np.empty(0, np.int64), np.uint64(0))
Array = npt.NDArray[np.float64]


def nodes(count: int = 500, bias: float = 0.5, seed: int = 0, blocks: Array = NONE, fixed: int = 0) -> Array:
    rng = np.random.default_rng(seed)
    return sample_nodes(START, END, count, bias, np.uint64(fixed), SIZES, blocks, HALF_PLANES, CORNERS, rng)


def is_on_line(poses: Array, pose: Array) -> npt.NDArray[np.bool_]:
    """Whether a push along a face's normal leads between poses `(n, 3)` and the pose."""
    off = poses[:, :2] - pose[:2]
    c, s = np.cos(pose[2]), np.sin(pose[2])
    across = np.minimum(np.abs(c * off[:, 0] + s * off[:, 1]), np.abs(c * off[:, 1] - s * off[:, 0]))
    return (across < 1e-9) & (np.abs(poses[:, 2] - pose[2]) < 1e-12)


def test_uniform_poses_fill_the_box_of_the_workspace() -> None:
    """Mean and variance of a uniform distribution are its middle and its width squared over twelve."""
    rng = np.random.default_rng(0)
    poses = np.array([draw_pose(CORNERS, rng) for _ in range(4000)])
    low, high = np.array([0.2, -0.4, -np.pi]), np.array([1.0, 0.4, np.pi])
    assert (poses >= low).all()
    assert (poses <= high).all()
    width = high - low
    # The mean of 4000 draws is off by width / sqrt(12 * 4000) on average; four times that is rare.
    assert (np.abs(poses.mean(axis=0) - (low + high) / 2) < 4 * width / np.sqrt(12 * 4000)).all()
    np.testing.assert_allclose(poses.var(axis=0), width**2 / 12, rtol=0.08)


def test_poses_on_push_lines_are_a_push_away_on_each_of_four_sides() -> None:
    rng = np.random.default_rng(0)
    poses = np.array([draw_on_line(END, SIZES, rng) for _ in range(2000)])
    assert is_on_line(poses, END).all()
    off = poses[:, :2] - END[:2]
    lengths, headings = np.hypot(*off.T), np.arctan2(off[:, 1], off[:, 0]) - END[2]
    assert lengths.min() >= SIZES.min_push
    assert lengths.max() <= SIZES.max_push
    sides = np.bincount(np.round(headings / QUARTER).astype(int) % 4, minlength=4)
    np.testing.assert_allclose(sides, 500, atol=90)  # four standard deviations, sqrt(2000 / 4 * 3 / 4) each


def test_the_roadmap_begins_with_start_and_end_and_has_as_many_poses_as_asked() -> None:
    found = nodes(count=60)
    assert found.shape == (62, 3)
    np.testing.assert_array_equal(found[:2], [START, END])


def test_all_poses_are_inside_the_workspace() -> None:
    assert all(is_inside(pose, SIZES, HALF_PLANES) for pose in nodes())


def test_poses_hit_no_block_that_stays_but_may_hit_one_that_moves() -> None:
    """Section III-B: poses that collide with blocks outside O_R are thrown out and drawn again."""
    blocks = outlines(np.array([[0.6, 0.0, 0.1], [0.8, -0.25, 0.0]]), SHAPE)
    hit = [int(block_hits(pose, SIZES, blocks)) for pose in nodes(blocks=blocks, fixed=0b01)[2:]]
    assert not any(h & 0b01 for h in hit)
    assert any(h & 0b10 for h in hit)


@pytest.mark.parametrize("bias", [0.0, 0.3, 1.0])
def test_the_share_of_poses_on_push_lines_is_epsilon(bias: float) -> None:
    """Three quarters of them lead to the end; uniform draws are on a line with probability zero.

    The lines are well inside the workspace, of which a uniform draw leaves out the seam along the sides;
    so `accepted` of the uniform draws count.
    """
    found = nodes(count=2000, bias=bias)[2:]
    at_end, at_start = is_on_line(found, END).sum(), is_on_line(found, START).sum()
    rng = np.random.default_rng(1)
    accepted = np.mean([is_inside(draw_pose(CORNERS, rng), SIZES, HALF_PLANES) for _ in range(4000)])
    expected = bias / (bias + (1 - bias) * accepted)
    assert (at_end + at_start) / len(found) == pytest.approx(expected, abs=0.04)
    if bias:
        assert at_end / (at_end + at_start) == pytest.approx(GOAL_SHARE, abs=0.06)


def test_the_same_seed_gives_the_same_poses_and_another_one_others() -> None:
    np.testing.assert_array_equal(nodes(seed=3), nodes(seed=3))
    assert not np.array_equal(nodes(seed=3)[2:], nodes(seed=4)[2:])


def clear_poses(seed: int, way: Way, blocks: Array, wanted: int = 1, tries: int = 200) -> Array:
    rng = np.random.default_rng(seed)
    others = np.uint64((1 << len(blocks)) - 1)
    return sample_clear_pose(
        START, way, SIZES, others, wanted, tries, SIZES, blocks, HALF_PLANES, CORNERS, rng
    )


@pytest.mark.parametrize("wanted", [1, 8])
def test_a_cleared_block_hits_nothing_and_is_not_in_the_way(wanted: int) -> None:
    blocks = outlines(np.array([[0.5, 0.0, 0.0], [0.7, 0.2, 0.5]]), SHAPE)
    carry = Way(np.array([START, END]), np.zeros(1, np.int64), np.uint64(0))
    for seed in range(40):
        (pose,) = clear_poses(seed, carry, blocks, wanted)
        assert is_inside(pose, SIZES, HALF_PLANES)
        assert not block_hits(pose, SIZES, blocks)
        assert not way_hits(carry, SIZES, outlines(pose[None], SHAPE))


def test_the_nearest_of_eight_clear_poses_is_half_as_far_away() -> None:
    """The first of them is among the eight, so none is farther; the mean distance falls by more than half."""
    first, nearest = (
        np.array([np.hypot(*(clear_poses(seed, NO_WAY, NONE, wanted)[0] - START)[:2]) for seed in range(60)])
        for wanted in (1, 8)
    )
    assert (nearest <= first).all()
    assert nearest.mean() < 0.5 * first.mean()


def test_no_pose_is_told_where_there_is_no_room() -> None:
    as_large_as_the_workspace = outlines(np.array([[0.6, 0.0, 0.0]]), [0.8, 0.8, 0.0])
    assert clear_poses(0, NO_WAY, as_large_as_the_workspace).shape == (0, 3)
