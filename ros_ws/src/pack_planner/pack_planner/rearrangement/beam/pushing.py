"""The pushes that the search knows: into a goal by way of a staging pose, from a spot, and out of a start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.blocks.planar import QUARTER, wrapped
from pack_core.blocks.primitive_action import PrimitiveKind
from pack_core.rotations import Array
from pack_planner.rearrangement.beam.refused_actions import bar_blocked, bar_grasps, bar_pushes
from pack_planner.rearrangement.beam.spots import POOL, STRAIGHT
from pack_planner.rearrangement.collisions import Words, hits
from pack_planner.rearrangement.footprints import fingers, squares, sweeps
from pack_planner.rearrangement.task import Task
from pack_planner.rearrangement.workspace import are_inside

Ints = npt.NDArray[np.int32]
OUT_LENGTHS = (0.006, 0.01, 0.015, 0.022, 0.03, 0.05, 0.08, 0.115)
"""Of pushes away from a start [m]."""


@dataclass(frozen=True)
class Pushes:
    """Any number of pushes, by where they end.

    Attributes:
        ends: poses `(..., 3)`.
        headings: [rad] `(...)`.
        lengths: [m] `(...)`.
    """

    ends: Array
    headings: Array
    lengths: Array

    @property
    def starts(self) -> Array:
        """Poses `(..., 3)`."""
        return _moved(self.ends, self.headings, -self.lengths)

    def hits(self, task: Task, blocks: Array) -> Words:
        """Which of the blocks `(Q, 6)` they hit, those that the arm refused all, `(..., W)`."""
        footprints = sweeps(self.ends, self.headings, self.lengths, task.side, task.gripper)
        words = hits(footprints[..., None, :], blocks)
        bar_blocked(task, footprints[..., None, :], words)
        bar_pushes(task, self.starts, self.headings, words)
        return words


@dataclass(frozen=True)
class PushesOut:
    """Pushes away from the starts of blocks that cannot be grasped there, K of them.

    Attributes:
        first: first row of every block `(n + 1,)`.
        spots: numbers of their ends `(K,)`.
        pushes: themselves.
    """

    first: Ints
    spots: Ints
    pushes: Pushes


def stages(task: Task) -> Pushes:
    """Pushes into the goals `(n, M)` from staging poses, the nearest first from all sides."""
    lengths = np.repeat(_lengths_into_goals(task), 4)
    headings = task.goals[:, 2, None] + QUARTER * np.tile(np.arange(4), len(lengths) // 4)
    ends = np.repeat(task.goals[:, None], len(lengths), axis=1)
    return Pushes(ends, headings, np.broadcast_to(lengths, headings.shape))


def _lengths_into_goals(task: Task) -> Array:
    """Lengths of pushes into a goal that are tried, the shortest first [m].

    The shortest leaves just room for a finger between the block and one that stands behind its goal; the
    others for fingers beside the block, clear of its neighbours.
    """
    slab = task.gripper.slab_thickness  # what a finger and its clearances take beside a face
    beside = (task.side + task.gripper.slab_width) / 2 + task.gripper.block_margin
    # 0.93 of a slab and a grid's gap of 2 mm together are a slab; half a millimetre more than one does
    # without the gap. The longer ones step over neighbours, up to the longest push, to which `inf` is cut.
    wanted = np.array([0.93 * slab, slab + 0.0005, 1.4 * slab, beside, 1.45 * beside, 1.9 * beside, np.inf])
    return np.unique(np.minimum(wanted, task.gripper.max_push))


def pushes_from_spots(task: Task, poses: Array) -> tuple[Ints, Pushes]:
    """Rows of pushes that lead from spots `(Q, 3)` to the blocks' goals `(n, Q)`, and these pushes `(L,)`."""
    goals, gripper = task.goals[:, None], task.gripper
    cosine, sine = np.cos(goals[..., 2]), np.sin(goals[..., 2])
    dx, dy = (goals - poses)[..., 0], (goals - poses)[..., 1]
    offsets = np.abs(np.stack([cosine * dx + sine * dy, cosine * dy - sine * dx]))
    length, aside = offsets.max(axis=0), offsets.min(axis=0)
    is_line = (aside < STRAIGHT) & (np.abs(wrapped(goals[..., 2] - poses[:, 2], QUARTER)) < STRAIGHT)
    is_line &= (length >= gripper.min_push - STRAIGHT) & (length <= gripper.max_push + STRAIGHT)
    # Of starts and goals only the starts that were snapped to a push line count as on it.
    is_line[:, :POOL] = False
    is_line[:, : task.n] = np.diag(task.is_ready)
    block, spot = np.nonzero(is_line)
    push_of = np.full(is_line.shape, -1, dtype=np.int32)
    push_of[block, spot] = np.arange(len(block))
    headings = np.arctan2(dy, dx)[block, spot]
    return push_of, Pushes(task.goals[block], headings, length[block, spot])


def pushes_out(task: Task, first_spot: int) -> PushesOut:
    """Pushes away from the starts of blocks that can be grasped by no axis as the others stand now."""
    beside = fingers(task.starts, task.side, task.gripper)
    picks = hits(beside, squares(task.starts, task.side))
    bar_blocked(task, beside, picks)
    bar_grasps(task, PrimitiveKind.GRASP, task.starts, picks)
    others = ~(np.uint64(1) << np.arange(task.n, dtype=np.uint64))
    stuck = np.flatnonzero(~task.is_home & np.all(picks[..., 0] & others[:, None], axis=1))
    lengths = np.broadcast_to(np.tile(OUT_LENGTHS, 4), (len(stuck), 4 * len(OUT_LENGTHS)))
    headings = task.starts[stuck, 2, None] + QUARTER * np.repeat(np.arange(4), len(OUT_LENGTHS))
    ends = _moved(np.repeat(task.starts[stuck, None], lengths.shape[1], axis=1), headings, lengths)
    is_allowed = are_inside(ends, task.side, task.half_planes) & (lengths <= task.gripper.max_push)
    counts = np.zeros(task.n, dtype=np.int32)
    counts[stuck] = is_allowed.sum(axis=1)
    return PushesOut(
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
        (first_spot + np.arange(is_allowed.sum())).astype(np.int32),
        Pushes(ends[is_allowed], headings[is_allowed], lengths[is_allowed]),
    )  # fmt: skip


def _moved(poses: Array, headings: Array, distances: Array) -> Array:
    """Poses `(..., 3)` moved along headings."""
    moved = poses.copy()
    moved[..., 0] += distances * np.cos(headings)
    moved[..., 1] += distances * np.sin(headings)
    return moved
