"""Where blocks may stand between start and goal: the poses that the search knows.

Spots are numbered: starts from 0, goals from GOAL, buffer poses from POOL on. A set of occupied spots is a
row of words, starts and goals in the first.
"""

from __future__ import annotations

import numpy as np

from pack_core.blocks.planar import QUARTER, wrapped
from pack_core.rotations import Array
from pack_planner.rearrangement.collisions import hits
from pack_planner.rearrangement.footprints import squares
from pack_planner.rearrangement.task import Task
from pack_planner.rearrangement.workspace import are_inside

GOAL, POOL = 32, 64
NO_GO = 31
"""A spot that counts as occupied always, so that what is impossible hits something even among no blocks."""
MAX_BLOCKS = 31
FAR = 1e6
"""Where spots are that do not exist [m]."""
LINE_STEP = 0.010
"""Between buffer poses on a push line [m]."""
APART = 0.006
"""Buffer poses of the same yaw nearer than this are one [m]."""
LINE_SHARE = 0.6
"""Of the pool at most for poses on push lines."""
STRAIGHT = 1e-6
"""Poses count as being on a push line up to this [m, rad]."""


def spot_poses(task: Task, pool: Array) -> Array:
    """Poses `(POOL + P, 3)` of all spots; a block that is home has no start of its own."""
    poses = np.full((POOL + len(pool), 3), FAR)
    poses[: task.n][~task.is_home] = task.starts[~task.is_home]
    poses[GOAL : GOAL + task.n] = task.goals
    poses[POOL:] = pool
    poses[:POOL, 0] += np.arange(POOL) * (poses[:POOL, 0] == FAR)
    return poses


def buffer_pool(task: Task, size: int, rng: np.random.Generator, *, is_over_goals: bool = False) -> Array:
    """Buffer poses `(up to size, 3)`: on the push lines of goals, then spread over the workspace.

    A block that waits on the push line of its goal goes home in one action even where it must be pushed. It
    is rarely worth it to wait on a line where it stands on goals as well, `is_over_goals`.
    """
    lines = _on_lines(task)
    if not is_over_goals:
        lines = _clear_of_goals(task, lines)
    lines = _thinned(lines, int(LINE_SHARE * size), rng)
    spread = _lattice(task, size - len(lines), rng)
    return np.vstack([lines, spread])[:size]


def _on_lines(task: Task) -> Array:
    distances = np.arange(task.side / 2, task.gripper.max_push + 1e-9, LINE_STEP)
    headings = task.goals[:, 2, None] + QUARTER * np.arange(4)
    ahead = np.stack([np.cos(headings), np.sin(headings)], axis=-1)[:, :, None] * distances[:, None]
    poses = np.empty((*ahead.shape[:-1], 3))
    poses[..., :2] = task.goals[:, None, None, :2] - ahead
    poses[..., 2] = wrapped(task.goals[:, 2], QUARTER)[:, None, None]
    poses = poses.reshape(-1, 3)
    return np.asarray(poses[are_inside(poses, task.side, task.half_planes)])


def _clear_of_goals(task: Task, poses: Array) -> Array:
    """Those that overlap no goal: a block in the grid's way is of little use."""
    grown = squares(poses, task.side, task.gripper.block_margin)[:, None]
    return np.asarray(poses[~hits(grown, squares(task.goals, task.side)).any(axis=1)])


def _thinned(poses: Array, size: int, rng: np.random.Generator) -> Array:
    """At most `size` of them, no two alike, in random order."""
    cells = np.round(np.column_stack([poses[:, :2] / APART, poses[:, 2] / 0.02])).astype(int)
    _, first = np.unique(cells, axis=0, return_index=True)
    return np.asarray(poses[rng.permutation(np.sort(first))[:size]])


def _lattice(task: Task, size: int, rng: np.random.Generator) -> Array:
    """A lattice over the workspace, as fine as `size` allows, with the yaw of the first goal."""
    corners = np.array(task.problem.workspace)
    yaw = float(wrapped(task.goals[0, 2], QUARTER))
    step = np.sqrt(np.prod(np.ptp(corners, axis=0)) / (4 * size))
    for _ in range(12):
        offset = rng.uniform(0.0, step, 2)
        axes = [np.arange(low + o, high, step) for low, high, o in
                zip(corners.min(0), corners.max(0), offset, strict=True)]  # fmt: skip
        x, y = (axis.ravel() for axis in np.meshgrid(*axes))
        poses = np.column_stack([x, y, np.full(x.size, yaw)])
        poses = poses[are_inside(poses, task.side, task.half_planes)]
        clear = _clear_of_goals(task, poses)
        if len(clear) <= size:
            return clear
        step *= 1.1
    return clear[rng.permutation(len(clear))[:size]]
