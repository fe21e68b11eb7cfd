"""What must be unfilled for a goal to be filled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER
from pack_core.rotations import Array
from pack_planner.rearrangement.assembly import BlockingSets
from pack_planner.rearrangement.collisions import Words, hits
from pack_planner.rearrangement.footprints import placings, squares, sweeps


@dataclass(frozen=True)
class GoalAccess:
    """For every goal the sets of goals of which one must be unfilled, to put a block down or to push it in.

    Of pushes only the end counts, so that no push, however short, is left out.
    """

    place: BlockingSets
    push: BlockingSets

    @classmethod
    def of(cls, goals: Array, side: float, gripper: GripperFootprint) -> GoalAccess:
        """Find what bars the access to goals at poses `(n, 3)`."""
        headings = goals[:, 2, None] + QUARTER * np.arange(4)
        ends = np.repeat(goals[:, None], 4, axis=1)
        pushes = sweeps(ends, headings, 0.0, side, gripper)[..., None, :]
        blocks = squares(goals, side)
        return cls(
            BlockingSets.of(sets_of_others(hits(placings(goals, side, gripper), blocks))),
            BlockingSets.of(sets_of_others(hits(pushes, blocks))),
        )


def sets_of_others(words: Words) -> list[list[int]]:
    """For every block the sets of others that its footprints `(n, ways, W)` hit, as bits."""
    values = [[sum(int(word) << 64 * w for w, word in enumerate(row)) for row in rows] for rows in words]
    return [[value & ~(1 << i) for value in row] for i, row in enumerate(values)]
