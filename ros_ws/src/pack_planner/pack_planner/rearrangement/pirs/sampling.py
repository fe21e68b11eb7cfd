"""Random poses of one block, compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from pack_core.rotations import Array
from pack_planner.rearrangement.pirs.geometry import QUARTER, Sizes, block_hits, is_inside, rectangle_at
from pack_planner.rearrangement.pirs.roadmap import Way, way_hits

TRIES = 40
"""Poses drawn for every one that is wanted, at most."""
GOAL_SHARE = 0.75
"""Of the poses on push lines: on those of the path's end; the others are on those of its start."""


@njit(cache=True)
def draw_pose(corners: Array, rng: np.random.Generator) -> Array:
    """Uniform in the bounding box of the corners `(n, 2)`, of any yaw."""
    pose = np.empty(3)
    for axis in range(2):
        pose[axis] = rng.uniform(corners[:, axis].min(), corners[:, axis].max())
    pose[2] = rng.uniform(-np.pi, np.pi)
    return pose


@njit(cache=True)
def draw_on_line(pose: Array, sizes: Sizes, rng: np.random.Generator) -> Array:
    """On one of the four lines on which a push leads to the pose or away from it."""
    heading = pose[2] + QUARTER * rng.integers(0, 4)
    distance = rng.uniform(sizes.min_push, sizes.max_push)
    return np.array([pose[0] + distance * np.cos(heading), pose[1] + distance * np.sin(heading), pose[2]])


@njit(cache=True)
def sample_nodes(
    start: Array, end: Array, count: int, bias: float, fixed: np.uint64, sizes: Sizes, squares: Array,
    half_planes: Array, corners: Array, rng: np.random.Generator,
) -> Array:  # fmt: skip
    """Start, end and up to `count` poses between them that hit none of the `fixed` blocks `(nodes, 3)`.

    With probability `bias` a pose is drawn on a push line, the narrow passage into a dense grid.
    """
    nodes = np.empty((count + 2, 3))
    nodes[0], nodes[1] = start, end
    found = 2
    for _ in range(TRIES * count):
        if found == count + 2:
            break
        if rng.uniform(0.0, 1.0) < bias:
            pose = draw_on_line(end if rng.uniform(0.0, 1.0) < GOAL_SHARE else start, sizes, rng)
        else:
            pose = draw_pose(corners, rng)
        if is_inside(pose, sizes, half_planes) and not block_hits(pose, sizes, squares) & fixed:
            nodes[found] = pose
            found += 1
    return nodes[:found]


@njit(cache=True)
def sample_clear_poses(
    way: Way, others: np.uint64, tries: int, sizes: Sizes, squares: Array, half_planes: Array, corners: Array,
    rng: np.random.Generator,
) -> Array:  # fmt: skip
    """A pose at which a block hits none of the `others` and is not in the way `(1, 3)`; else `(0, 3)`."""
    half = sizes.side / 2
    square = np.empty((1, 6))
    poses = np.empty((1, 3))
    for _ in range(tries):
        poses[0] = draw_pose(corners, rng)
        if is_inside(poses[0], sizes, half_planes) and not block_hits(poses[0], sizes, squares) & others:
            square[0] = rectangle_at(poses[0], 0.0, 0.0, half, half)
            if not way_hits(way, sizes, square):
                return poses
    return poses[:0]
