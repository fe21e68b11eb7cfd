"""What the arm moves among: the table, and the blocks where they were seen."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.cells.blocks import BlocksCell
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rearrangement.planar import PlanarPose
from pack_core.rotations import Pose

TABLE = "table"
THICKNESS = 0.04
"""Of the table's top [m]."""


class Surroundings:
    """Makes obstacles.

    Args:
        cell: whose table it is.
        side: of a block [m].
    """

    def __init__(self, cell: BlocksCell, side: float) -> None:
        (x, y), size = cell.table.centre, cell.table.size
        self._table = Obstacle(TABLE, Pose(np.array([x, y, -0.5 * THICKNESS])), np.array([*size, THICKNESS]))
        self._side = side

    def among(self, poses: Mapping[str, PlanarPose], without: str = "") -> tuple[Obstacle, ...]:
        """The table and the blocks at these poses but for one."""
        size, z = np.full(3, self._side), 0.5 * self._side
        blocks = (Obstacle(name, pose.pose(z), size) for name, pose in poses.items() if name != without)
        return (self._table, *blocks)

    def carried(self, X_WT: Pose, block: PlanarPose) -> CarriedBox:
        """A block that goes with the tool from where both are now."""
        return CarriedBox(X_WT.inverse() @ block.pose(0.5 * self._side), np.full(3, self._side))
