"""All geometry of a search, computed once: which spots every action would hit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pack_core.blocks.planar import QUARTER, wrapped
from pack_core.blocks.primitive_action import PrimitiveKind
from pack_core.rotations import Array
from pack_planner.rearrangement.assembly import MAX_GOALS, BlockingSets, assembly_planes
from pack_planner.rearrangement.beam.spots import (
    EVERYTHING,
    GOAL,
    POOL,
    STRAIGHT,
    BufferPool,
    Ints,
    bar_blocked,
    bar_grasps,
    fits,
    pushes_from_spots,
    pushes_out,
    spot_poses,
    spot_shapes,
    stages,
)
from pack_planner.rearrangement.footprints import Words, are_inside, fingers, hits, outlines, too_wide
from pack_planner.rearrangement.snapped_problem import SnappedProblem

MEMO_BITS = 16
"""Results about sets that are remembered, as a power of two."""


class PushPrice(NamedTuple):
    """What a push costs beyond a pick-and-place action, in pick-and-place actions.

    A pick-and-place action costs alpha_1 and a push alpha_2 (Eq. 1 of Sotiropoulos and Sandzimier; the number
    of blocks in collision is zero for what is carried out), and a push costs more the longer it is (their
    Section V). In units of alpha_1 a plan of k actions then costs k plus its premium, the sum of
    `extra + per_metre * length` over its pushes. With both zero, a plan costs its number of actions.

    Attributes:
        extra: alpha_2 / alpha_1 - 1.
        per_metre: price of a push's length [1/m], divided by alpha_1.
    """

    extra: float
    per_metre: float

    def premium(self, length: float) -> float:
        """Of a push of a length [m], in pick-and-place actions."""
        return self.extra + self.per_metre * length


FREE = PushPrice(0.0, 0.0)
"""A push costs as much as any other action."""


class Tables(NamedTuple):
    """Collisions as words over spots; W words a row, n blocks, Q spots, M ways to stage.

    Attributes:
        poses: of the spots `(Q, 3)`.
        fits: a spot is for blocks of this one's shape `(n, Q)`.
        pick: of grasping at a spot `(Q, 2, W)`.
        place: of putting down at a spot `(Q, 2, W)`.
        denied: spots at which nothing can be put down while a spot is occupied `(Q, 2, W)`.
        swap: the grasp's axis of a block is the other one of the spot's axes `(n, Q)`.
        is_symmetric: a block may be turned by a quarter.
        stage: poses from which a block can be pushed into its goal `(n, M, 3)`, the nearest first.
        stage_place: of putting down there `(n, M, 2, W)`.
        stage_push: of the push from there `(n, M, W)`.
        push_of: row of `push` that leads from a spot to the block's goal, -1 for none `(n, Q)`.
        push: of pushes from spots `(L, W)`.
        out_first: first row of the pushes away from every start `(n + 1,)`.
        out_spot: where they end `(K,)`.
        out: `(K, W)`.
        crowds: goals that a block at a spot overlaps, and those where it leaves no grasp, as bits `(Q, 2)`.
        place_at: sets of goals, as bits, one of which must be unfilled to put a block down `(n, ways)`.
        push_at: sets one of which must be unfilled to push it in `(n, ways)`.
        memo, memo_keys: of `likely_pushes`, which fills them.
        planes: assembly pattern database of the first goals.
        upper_planes: of the other goals.
        split: number of goals in the first.
        hash: of a block at a spot `(n, Q)`.
        push_price: what pushes cost beyond other actions.
    """

    poses: Array
    fits: npt.NDArray[np.bool_]
    pick: Words
    place: Words
    denied: Words
    swap: npt.NDArray[np.bool_]
    is_symmetric: bool
    stage: Array
    stage_place: Words
    stage_push: Words
    push_of: Ints
    push: Words
    out_first: Ints
    out_spot: Ints
    out: Words
    crowds: Words
    place_at: Words
    push_at: Words
    memo: Words
    memo_keys: Words
    planes: Words
    upper_planes: Words
    split: int
    hash: Words
    push_price: PushPrice


def build_tables(snapped: SnappedProblem, pool: BufferPool, push_price: PushPrice = FREE) -> Tables:
    """Compute the tables of a problem with a buffer pool, to which ends of pushes out are added."""
    out = pushes_out(snapped, POOL + len(pool))
    pool += BufferPool(out.pushes.ends, out.pushes.shapes)
    poses, shapes = spot_poses(snapped, pool.poses), spot_shapes(snapped, pool)
    blocks = outlines(poses, shapes)
    pick, place = _grasps_at(snapped, poses, shapes, blocks)
    stage = stages(snapped)
    _, stage_place = _grasps_at(snapped, stage.starts, stage.shapes, blocks)
    stage_place[~are_inside(stage.starts, stage.shapes, snapped.half_planes)] = EVERYTHING
    stage_push = stage.hits(snapped, blocks)
    is_own_end = out.is_own_end(len(poses))
    push_of, from_spots = pushes_from_spots(snapped, poses, shapes, is_own_end)
    placed = place[GOAL : GOAL + snapped.n]
    into_place, into_push = _ways_into_goals(placed, stage_place, stage_push)
    planes, upper_planes, split = _assembly(into_place, into_push)
    return Tables(
        poses=poses,
        fits=fits(snapped, shapes),
        pick=pick,
        place=place,
        denied=_turned_round(place),
        swap=_swaps(snapped, poses) & ~is_own_end,  # there a block has its start's axes
        is_symmetric=snapped.problem.symmetry == 4,
        stage=stage.starts,
        stage_place=stage_place,
        stage_push=stage_push,
        push_of=push_of,
        push=from_spots.hits(snapped, blocks),
        out_first=out.first,
        out_spot=out.spots,
        out=out.pushes.hits(snapped, blocks),
        crowds=_crowds(snapped, blocks, placed),
        place_at=into_place.rows(),
        push_at=into_push.rows(),
        memo=np.zeros(1 << MEMO_BITS, dtype=np.uint64),
        memo_keys=np.zeros(1 << MEMO_BITS, dtype=np.uint64),
        planes=planes,
        upper_planes=upper_planes,
        split=split,
        hash=np.random.default_rng(0).integers(2**63, size=push_of.shape, dtype=np.uint64),
        push_price=push_price,
    )


def _grasps_at(snapped: SnappedProblem, poses: Array, shapes: Array, blocks: Array) -> tuple[Words, Words]:
    """What grasping and what putting down hits at poses `(..., 3)` of shapes `(..., 3)`, `(..., 2, W)` each.

    What the arm refused, what would hit an obstacle, and what the gripper does not open enough for, hits all.
    """
    beside = fingers(poses, shapes, snapped.gripper)
    under = outlines(poses, shapes, snapped.gripper.block_margin)[..., None, :]
    pick = hits(beside, blocks)
    pick[too_wide(shapes, snapped.gripper)] = EVERYTHING
    place = pick | hits(under, blocks)[..., None, :]
    bar_blocked(snapped, beside, pick, place)
    bar_blocked(snapped, under, place)
    bar_grasps(snapped, PrimitiveKind.GRASP, poses, pick)
    bar_grasps(snapped, PrimitiveKind.PLACE, poses, place)
    return pick, place


def _swaps(snapped: SnappedProblem, poses: Array) -> npt.NDArray[np.bool_]:
    """Where a block that is to end at its goal's yaw lies across: by an odd number of quarters."""
    turns = snapped.goals[:, 2, None] - poses[:, 2]
    is_square = np.abs(wrapped(turns, QUARTER)) < STRAIGHT
    is_square &= snapped.is_square[:, None]
    swaps = is_square & (np.round(turns / QUARTER) % 2 == 1)
    swaps[:, :POOL] = False
    return np.asarray(swaps)


def _turned_round(place: Words) -> Words:
    """The relation `(Q, 2, W)` from what is hit to what hits it."""
    spots = len(place)
    turned = np.zeros((spots, 2, 64 * place.shape[-1]), dtype=np.uint8)
    turned[..., :spots] = _bits(place)[..., :spots].transpose(2, 1, 0)
    return np.packbits(turned, axis=-1, bitorder="little").view(np.uint64)


def _crowds(snapped: SnappedProblem, blocks: Array, placed: Words) -> Words:
    overlap = hits(outlines(snapped.goals, snapped.shapes, snapped.gripper.block_margin)[:, None], blocks)
    goals = np.uint64(1) << np.arange(snapped.n, dtype=np.uint64)
    sets = [_bits(words)[:, : len(blocks)].T @ goals for words in (overlap, placed[:, 0] & placed[:, 1])]
    return np.stack(sets, axis=1)


def _bits(words: Words) -> npt.NDArray[np.uint8]:
    """Words `(..., W)` as bits `(..., 64 W)`."""
    return np.unpackbits(np.ascontiguousarray(words).view(np.uint8), axis=-1, bitorder="little")


def _ways_into_goals(
    placed: Words, stage_place: Words, stage_push: Words
) -> tuple[BlockingSets, BlockingSets]:
    """Putting down and pushing, as far as filled goals are concerned."""
    staged = stage_place | stage_push[:, :, None]
    return (
        BlockingSets.of(_goal_sets(words[:, 0], i) for i, words in enumerate(placed)),
        BlockingSets.of(_goal_sets(words[..., 0], i) for i, words in enumerate(staged)),
    )


def _assembly(place: BlockingSets, push: BlockingSets) -> tuple[Words, Words, int]:
    """Pattern databases, and the number of goals in the first."""
    n = len(place.alternatives)
    if n <= MAX_GOALS:
        return assembly_planes(place, push), assembly_planes(BlockingSets(()), BlockingSets(())), n
    half = n // 2
    lower, upper = ((place.within(*part), push.within(*part)) for part in ((0, half), (half, n - half)))
    return assembly_planes(*lower), assembly_planes(*upper), half


def _goal_sets(words: Words, own: int) -> list[int]:
    return [int(word) >> GOAL & ~(1 << own) for word in words.ravel() if word != EVERYTHING]
