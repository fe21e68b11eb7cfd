"""The tool's goals for the box in work, sorted by how far the wrist must turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.motion.moves import Move
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Array, Pose, to_matrix
from pallet_fsm.orientations import by_turning
from pallet_fsm.states import State
from pallet_fsm.tool_poses import Stand, ToolPoseConfig, grasps, placements, stands
from pallet_fsm.work_item import WorkItem


@dataclass(frozen=True)
class Leg:
    """A move up to the next stop of the arm.

    Attributes:
        move: the move as the motion takes it.
        X_WT: pose of the tool at its end.
        end: the state in which it ends.
        approach: approach direction of the tool at the end, where it stands a box up `(3,)`; else None.
    """

    move: Move
    X_WT: Pose
    end: State
    approach: Array | None = None


class Goals:
    """Finds tool poses over boxes, at table B and over places on the pallet.

    Args:
        cell: the cell's physical facts.
        config: distances.
    """

    def __init__(self, cell: PalletizingCell, config: ToolPoseConfig) -> None:
        self._cell, self._config = cell, config

    def grasps(self, item: WorkItem, X_WT: Pose) -> list[Pose]:
        """Tool poses on the top face of the box where it stands."""
        assert item.X_WB is not None
        return self._sorted(grasps(item.X_WB, item.dims, self._config), X_WT)

    def stands(self, item: WorkItem, X_WT: Pose) -> list[Stand]:
        """Ways to stand the gripped box up at the edge of table B."""
        assert item.X_TB is not None
        found = stands(item.box, item.X_TB, self._cell, self._config)
        order = self._sorted([stand.X_WT for stand in found], X_WT)
        return [next(stand for stand in found if stand.X_WT is goal) for goal in order]

    def placements(self, item: WorkItem, X_WT: Pose) -> list[Pose]:
        """Tool poses at which the gripped box is at its place on the pallet."""
        assert item.X_TB is not None
        pallet = self._cell.pallet
        return self._sorted(
            placements(item.plan.placed, item.box, item.X_TB, pallet.X_WP, self._config), X_WT
        )

    def in_world(self, v_P: Array) -> Array:
        """A vector `(3,)` that is given along the pallet's axes, along the world's.

        A pallet stands a little askew, and the boxes on it with it: a box that came down along the world's
        vertical would come nearer to a tall neighbour on its way than it is at its place.
        """
        return np.asarray(to_matrix(self._cell.pallet.X_WP.q) @ v_P)

    def _sorted(self, goals: list[Pose], X_WT: Pose) -> list[Pose]:
        return by_turning(goals, X_WT, self._cell.arm.X_WB.p)


def raised(X_WT: Pose, offset: Array) -> Pose:
    """The pose, displaced by an offset `(3,)` [m] in the world frame."""
    return Pose(X_WT.p + offset, X_WT.q)
