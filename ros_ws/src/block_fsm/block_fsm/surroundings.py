"""What the arm moves among: the table, and the blocks where they were seen."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.planar import PlanarPose
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose

TABLE = "table"
THICKNESS = 0.04
"""Of the table's top [m]."""
TOUCHING = 0.001
"""Blocks that are seen this near to each other may touch [m]."""
CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


class Surroundings:
    """Makes the obstacles that a move is checked against.

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

    def beside(self, block: str, poses: Mapping[str, PlanarPose]) -> frozenset[str]:
        """The table and the other blocks that a block may touch where it stands."""
        others = [name for name in poses if name != block]
        near = {name for name in others if self._gap(poses[block], poses[name]) < TOUCHING}
        return frozenset({TABLE, *near})

    def _gap(self, a: PlanarPose, b: PlanarPose) -> float:
        """Between two blocks on the table [m]: from the corners of one to the sides of the other."""
        return min(self._reach(a, b), self._reach(b, a))

    def _reach(self, a: PlanarPose, b: PlanarPose) -> float:
        half = 0.5 * self._side
        corners = a.p + half * CORNERS @ _turn(a.yaw).T
        beyond = np.maximum(np.abs((corners - b.p) @ _turn(b.yaw)) - half, 0.0)
        return float(np.linalg.norm(beyond, axis=1).min())


def _turn(yaw: float) -> Array:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])
