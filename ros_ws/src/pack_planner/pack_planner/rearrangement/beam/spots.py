"""The poses and pushes that the search knows: where blocks may stand, and how they may be pushed.

Spots are numbered: starts from 0, goals from GOAL, buffer poses from POOL on. A spot is a pose for blocks of
one shape: a start or a goal is its block's, and every shape has buffer poses of its own. A set of occupied
spots is a row of words, starts and goals in the first.

Pushes lead into a goal by way of a staging pose, from a spot on a push line, and out of a start. What the arm
refused before, and what an obstacle bars, hits everything, so that it is impossible to the search.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_core.blocks.planar import QUARTER, wrapped
from pack_core.blocks.primitive_action import PrimitiveKind
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import (
    Words,
    are_inside,
    fingers,
    hits,
    outlines,
    sweeps,
    too_wide,
)
from pack_planner.rearrangement.snapped_problem import SnappedProblem

Ints = npt.NDArray[np.int32]
OUT_LENGTHS = (0.006, 0.01, 0.015, 0.022, 0.03, 0.05, 0.08, 0.115)
"""Of pushes away from a start [m]: about evenly spread on a logarithmic scale up to the longest push."""
EVERYTHING = np.uint64(2**64 - 1)
"""What is impossible hits all spots, NO_GO among them."""
GOAL, POOL = 32, 64
"""First numbers of goals and of buffer poses: starts and goals share the first word of 64 bits, half each."""
NO_GO = 31
"""A spot that counts as occupied always, so that what is impossible hits something even among no blocks."""
NO_SPOT = -1
"""Instead of the number of a spot: there is no further one."""
MAX_BLOCKS = 31
"""Starts that there are numbers for, NO_GO left out."""
FAR = 1e6
"""Where spots are that do not exist [m]."""
LINE_STEP = 0.010
"""Between buffer poses on a push line [m], a fifth of a block's side."""
APART = 0.006
"""Buffer poses of the same yaw nearer than this are one [m]."""
LINE_SHARE = 0.6
"""Of the pool at most for poses on push lines."""
STRAIGHT = 1e-6
"""Poses count as being on a push line up to this [m, rad]."""


@dataclass(frozen=True)
class BufferPool:
    """Poses at which blocks can wait, each for blocks of one shape.

    Attributes:
        poses: `(P, 3)`.
        shapes: of the blocks that they are for `(P, 3)`.
    """

    poses: Array
    shapes: Array

    def __add__(self, other: BufferPool) -> BufferPool:
        return BufferPool(np.vstack([self.poses, other.poses]), np.vstack([self.shapes, other.shapes]))

    def __len__(self) -> int:
        return len(self.poses)


def spot_shapes(snapped: SnappedProblem, pool: BufferPool) -> Array:
    """Shapes `(POOL + P, 3)` of the blocks that the spots are for."""
    shapes = np.zeros((POOL + len(pool), 3))
    shapes[: snapped.n] = shapes[GOAL : GOAL + snapped.n] = snapped.shapes
    shapes[POOL:] = pool.shapes
    return shapes


def spot_poses(snapped: SnappedProblem, pool: Array) -> Array:
    """Poses `(POOL + P, 3)` of all spots; a block that is home has no start of its own."""
    poses = np.full((POOL + len(pool), 3), FAR)
    poses[: snapped.n][~snapped.is_home] = snapped.starts[~snapped.is_home]
    poses[GOAL : GOAL + snapped.n] = snapped.goals
    poses[POOL:] = pool
    poses[:POOL, 0] += np.arange(POOL) * (poses[:POOL, 0] == FAR)
    return poses


def buffer_pool(
    snapped: SnappedProblem, size: int, rng: np.random.Generator, *, is_over_goals: bool = False
) -> BufferPool:
    """Up to `size` buffer poses for every shape: on push lines of goals, then spread over the workspace.

    A block that waits on the push line of its goal goes home in one action even where it must be pushed. It
    is rarely worth it to wait on a line where it stands on goals as well, `is_over_goals`.
    """
    pool = BufferPool(np.empty((0, 3)), np.empty((0, 3)))
    for shape in np.unique(snapped.shapes, axis=0):
        goals = snapped.goals[(snapped.shapes == shape).all(axis=1)]
        lines = _on_lines(snapped, shape, goals)
        if not is_over_goals:
            lines = _clear_of_goals(snapped, shape, lines)
        lines = _thinned(lines, int(LINE_SHARE * size), rng)
        spread = _lattice(snapped, shape, goals, size - len(lines), rng)
        poses = np.vstack([lines, spread])[:size]
        pool += BufferPool(poses, np.broadcast_to(shape, poses.shape))
    return pool


def _on_lines(snapped: SnappedProblem, shape: Array, goals: Array) -> Array:
    distances = np.arange(shape[:2].min() / 2, snapped.gripper.max_push + 1e-9, LINE_STEP)
    headings = goals[:, 2, None] + QUARTER * np.arange(4)
    ahead = np.stack([np.cos(headings), np.sin(headings)], axis=-1)[:, :, None] * distances[:, None]
    poses = np.empty((*ahead.shape[:-1], 3))
    poses[..., :2] = goals[:, None, None, :2] - ahead
    poses[..., 2] = wrapped(goals[:, 2], _alike_after(shape))[:, None, None]
    poses = poses.reshape(-1, 3)
    return np.asarray(poses[are_inside(poses, shape, snapped.half_planes)])


def _alike_after(shape: Array) -> float:
    """Turn after which a place for a block of a shape is the same place [rad]."""
    return QUARTER if shape[0] == shape[1] else 2 * QUARTER


def _clear_of_goals(snapped: SnappedProblem, shape: Array, poses: Array) -> Array:
    """Those that overlap no goal: a block in the grid's way is of little use."""
    grown = outlines(poses, shape, snapped.gripper.block_margin)[:, None]
    return np.asarray(poses[~hits(grown, outlines(snapped.goals, snapped.shapes)).any(axis=1)])


def _thinned(poses: Array, size: int, rng: np.random.Generator) -> Array:
    """At most `size` of them, no two alike, in random order."""
    cells = np.round(np.column_stack([poses[:, :2] / APART, poses[:, 2] / 0.02])).astype(int)
    _, first = np.unique(cells, axis=0, return_index=True)
    return np.asarray(poses[rng.permutation(np.sort(first))[:size]])


def _lattice(
    snapped: SnappedProblem, shape: Array, goals: Array, size: int, rng: np.random.Generator
) -> Array:
    """A lattice over the workspace, as fine as `size` allows, with the yaw of the first goal."""
    corners = np.array(snapped.problem.workspace)
    yaw = float(wrapped(goals[0, 2], _alike_after(shape)))
    step = np.sqrt(np.prod(np.ptp(corners, axis=0)) / (4 * size))
    for _ in range(12):
        offset = rng.uniform(0.0, step, 2)
        axes = [np.arange(low + o, high, step) for low, high, o in
                zip(corners.min(0), corners.max(0), offset, strict=True)]  # fmt: skip
        x, y = (axis.ravel() for axis in np.meshgrid(*axes))
        poses = np.column_stack([x, y, np.full(x.size, yaw)])
        poses = poses[are_inside(poses, shape, snapped.half_planes)]
        clear = _clear_of_goals(snapped, shape, poses)
        if len(clear) <= size:
            return clear
        step *= 1.1
    return clear[rng.permutation(len(clear))[:size]]


def bar_grasps(snapped: SnappedProblem, kind: PrimitiveKind, poses: Array, words: Words) -> None:
    """Change what grasping or putting down hits at poses `(..., 3)`, words `(..., 2, W)`."""
    turned = np.repeat(poses[..., None, :], 2, axis=-2)
    turned[..., 1, 2] += QUARTER
    _bar(snapped, kind, turned, words)


def bar_pushes(snapped: SnappedProblem, starts: Array, headings: Array, words: Words) -> None:
    """Change what pushes from `(..., 3)` along headings `(...)` hit, words `(..., W)`."""
    _bar(snapped, PrimitiveKind.PUSH, np.concatenate([starts[..., :2], headings[..., None]], axis=-1), words)


def bar_blocked(snapped: SnappedProblem, footprints: Array, *tables: Words) -> None:
    """Change what actions with footprints `(..., rectangles, 6)` hit, tables of words `(..., W)`."""
    is_blocked = hits(footprints, snapped.obstacles).any(axis=-1)
    for words in tables:
        words[is_blocked] = EVERYTHING


def _bar(snapped: SnappedProblem, kind: PrimitiveKind, poses: Array, words: Words) -> None:
    for primitive in snapped.problem.refused:
        words[primitive.is_like(kind, poses)] = EVERYTHING


@dataclass(frozen=True)
class Pushes:
    """Any number of pushes, by where they end.

    Attributes:
        ends: poses `(..., 3)`.
        headings: [rad] `(...)`.
        lengths: [m] `(...)`.
        shapes: of the blocks that are pushed `(..., 3)`.
    """

    ends: Array
    headings: Array
    lengths: Array
    shapes: Array

    @property
    def starts(self) -> Array:
        """Poses `(..., 3)`."""
        return _moved(self.ends, self.headings, -self.lengths)

    def hits(self, snapped: SnappedProblem, blocks: Array) -> Words:
        """Which of the blocks `(Q, 6)` they hit, those that the arm refused all, `(..., W)`."""
        footprints = sweeps(self.ends, self.headings, self.lengths, self.shapes, snapped.gripper)
        words = hits(footprints[..., None, :], blocks)
        bar_blocked(snapped, footprints[..., None, :], words)
        bar_pushes(snapped, self.starts, self.headings, words)
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

    def is_own_end(self, spots: int) -> npt.NDArray[np.bool_]:
        """Where a block is that was pushed out of its start, of so many spots `(n, spots)`."""
        blocks = np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))
        is_own = np.zeros((len(self.first) - 1, spots), dtype=bool)
        is_own[blocks, self.spots] = True
        return is_own


def stages(snapped: SnappedProblem) -> Pushes:
    """Pushes into the goals `(n, M)` from staging poses, the nearest first from all sides."""
    lengths = np.repeat(_lengths_into_goals(snapped), 4)
    headings = snapped.goals[:, 2, None] + QUARTER * np.tile(np.arange(4), len(lengths) // 4)
    ends = np.repeat(snapped.goals[:, None], len(lengths), axis=1)
    shapes = np.broadcast_to(snapped.shapes[:, None], ends.shape)
    return Pushes(ends, headings, np.broadcast_to(lengths, headings.shape), shapes)


def _lengths_into_goals(snapped: SnappedProblem) -> Array:
    """Lengths of pushes into a goal that are tried, the shortest first [m].

    The shortest leaves just room for a finger between the block and one that stands behind its goal; the
    others for fingers beside the block, clear of its neighbours.
    """
    gripper, shapes = snapped.gripper, snapped.shapes
    # What a finger and its clearances take beside a face, and the half of a block and of a finger beside it.
    slabs = gripper.slab_thickness + gripper.finger_taper * np.unique(shapes[:, 2])
    besides = (np.unique(shapes[:, :2]) + gripper.slab_width) / 2 + gripper.block_margin
    # 0.93 of a slab and a grid's gap of 2 mm together are a slab; half a millimetre more than one does
    # without the gap. The longer ones step over neighbours, up to the longest push, to which `inf` is cut.
    short = [length for slab in slabs for length in (0.93 * slab, slab + 0.0005, 1.4 * slab)]
    long = [length for beside in besides for length in (beside, 1.45 * beside, 1.9 * beside)]
    return np.unique(np.minimum([*short, *long, np.inf], gripper.max_push))


def pushes_from_spots(
    snapped: SnappedProblem, poses: Array, shapes: Array, is_own_end: npt.NDArray[np.bool_]
) -> tuple[Ints, Pushes]:
    """Rows of pushes that lead from spots `(Q, 3)` to the blocks' goals `(n, Q)`, and these pushes `(L,)`.

    The spots are for blocks of shapes `(Q, 3)`; those of `is_own_end` `(n, Q)` are where pushes out end.
    """
    goals, gripper = snapped.goals[:, None], snapped.gripper
    cosine, sine = np.cos(goals[..., 2]), np.sin(goals[..., 2])
    dx, dy = (goals - poses)[..., 0], (goals - poses)[..., 1]
    offsets = np.abs(np.stack([cosine * dx + sine * dy, cosine * dy - sine * dx]))
    length, aside = offsets.max(axis=0), offsets.min(axis=0)
    is_line = (aside < STRAIGHT) & (np.abs(wrapped(goals[..., 2] - poses[:, 2], QUARTER)) < STRAIGHT)
    is_line &= fits(snapped, shapes) & ~is_crosswise(snapped, poses)
    is_line &= (length >= gripper.min_push - STRAIGHT) & (length <= gripper.max_push + STRAIGHT)
    # Of starts and goals only the starts that were snapped to a push line count as on it.
    is_line[:, :POOL] = False
    is_line[:, : snapped.n] = np.diag(snapped.is_ready)
    # A push turns no block: one that was pushed out still has the yaw of its start.
    is_line &= ~is_own_end | ~_is_turned(snapped)[:, None]
    block, spot = np.nonzero(is_line)
    push_of = np.full(is_line.shape, -1, dtype=np.int32)
    push_of[block, spot] = np.arange(len(block))
    headings = np.arctan2(dy, dx)[block, spot]
    return push_of, Pushes(snapped.goals[block], headings, length[block, spot], snapped.shapes[block])


def _is_turned(snapped: SnappedProblem) -> npt.NDArray[np.bool_]:
    """Which blocks have another yaw at their starts than their goals ask for `(n,)`."""
    turns = wrapped(snapped.goals[:, 2] - snapped.starts[:, 2], 2 * np.pi / snapped.problem.symmetry)
    return np.asarray(np.abs(turns) > STRAIGHT)


def fits(snapped: SnappedProblem, shapes: Array) -> npt.NDArray[np.bool_]:
    """Which blocks the spots of shapes `(Q, 3)` are for `(n, Q)`."""
    return np.asarray((snapped.shapes[:, None] == shapes).all(axis=-1))


def is_crosswise(snapped: SnappedProblem, poses: Array) -> npt.NDArray[np.bool_]:
    """Whether an oblong block lies across its goal at poses `(Q, 3)`; a square one never does `(n, Q)`."""
    turns = np.abs(wrapped(snapped.goals[:, 2, None] - poses[:, 2], 2 * QUARTER))
    return np.asarray(~snapped.is_square[:, None] & (turns > QUARTER / 2))


def pushes_out(snapped: SnappedProblem, first_spot: int) -> PushesOut:
    """Pushes away from the starts of blocks that can be grasped by no axis as the others stand now."""
    beside = fingers(snapped.starts, snapped.shapes, snapped.gripper)
    picks = hits(beside, outlines(snapped.starts, snapped.shapes))
    picks[too_wide(snapped.shapes, snapped.gripper)] = EVERYTHING
    bar_blocked(snapped, beside, picks)
    bar_grasps(snapped, PrimitiveKind.GRASP, snapped.starts, picks)
    others = ~(np.uint64(1) << np.arange(snapped.n, dtype=np.uint64))
    stuck = np.flatnonzero(~snapped.is_home & np.all(picks[..., 0] & others[:, None], axis=1))
    lengths = np.broadcast_to(np.tile(OUT_LENGTHS, 4), (len(stuck), 4 * len(OUT_LENGTHS)))
    headings = snapped.starts[stuck, 2, None] + QUARTER * np.repeat(np.arange(4), len(OUT_LENGTHS))
    ends = _moved(np.repeat(snapped.starts[stuck, None], lengths.shape[1], axis=1), headings, lengths)
    shapes = np.broadcast_to(snapped.shapes[stuck, None], ends.shape)
    is_allowed = are_inside(ends, shapes, snapped.half_planes) & (lengths <= snapped.gripper.max_push)
    counts = np.zeros(snapped.n, dtype=np.int32)
    counts[stuck] = is_allowed.sum(axis=1)
    return PushesOut(
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
        (first_spot + np.arange(is_allowed.sum())).astype(np.int32),
        Pushes(ends[is_allowed], headings[is_allowed], lengths[is_allowed], shapes[is_allowed]),
    )  # fmt: skip


def _moved(poses: Array, headings: Array, distances: Array) -> Array:
    """Poses `(..., 3)` moved along headings."""
    moved = poses.copy()
    moved[..., 0] += distances * np.cos(headings)
    moved[..., 1] += distances * np.sin(headings)
    return moved
