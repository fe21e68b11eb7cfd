"""Tool poses to grasp a box, to stand it up at the table's edge, and to put it on the pallet.

Every function gives alternatives, since box and tool are symmetric under half or quarter turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from pack_core.motion.moves import DOWN
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.order import OrderBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import (
    POINTING_DOWN,
    Array,
    Pose,
    angle_between,
    from_matrix,
    from_yaw,
    multiply,
    rotate,
    to_matrix,
)
from pallet_fsm.palletizer_config import ToolPoseConfig

EQUAL = 1e-6
"""Edges that differ by less count as equal [m]."""
ALONG = 0.9
"""Cosine from which two directions count as the same; those compared are quarter turns apart."""


def _signed_permutations() -> Array:
    """The 24 proper rotations of a cube `(24, 3, 3)`."""
    matrices = (
        np.eye(3)[list(order)] * np.array(signs)[:, None]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    )
    return np.array([matrix for matrix in matrices if np.linalg.det(matrix) > 0.0])  # -1: with a reflection


CUBE = _signed_permutations()
QUATERNIONS = tuple(from_matrix(R) for R in CUBE)


def box_orientations(dims: Sequence[float], extents: Sequence[float | None]) -> list[Array]:
    """Orientations q_WB, wxyz, in which a box with edges `dims` [m] has given extents along the world's axes.

    Args:
        dims: edges of the box along its own axes [m].
        extents: wanted extent along each axis of the world [m]; None: any.
    """
    edges = np.abs(CUBE) @ np.asarray(dims)
    wanted = np.array([np.nan if want is None else want for want in extents])
    is_one = np.all(np.isnan(wanted) | (np.abs(edges - wanted) < EQUAL), axis=1)
    return [QUATERNIONS[i].copy() for i in np.flatnonzero(is_one)]


def points_along(X_WT: Pose, direction: Array) -> bool:
    """Whether the tool's approach axis z points along a unit vector of the world."""
    return float(rotate(X_WT.q, np.array([0.0, 0.0, 1.0])) @ direction) > ALONG


@dataclass(frozen=True)
class Stand:
    """A box stood up at the table's edge: its pose when let go, the tool's, the approach direction."""

    X_WB: Pose
    X_WT: Pose
    approach: Array


def grasps(X_WB: Pose, dims: Array, config: ToolPoseConfig) -> list[Pose]:
    """Tool poses X_WT over the middle of the upper face of a box that stands on a level plane."""
    heights = np.abs(to_matrix(X_WB.q)) @ dims
    p_WT = X_WB.p + np.array([0.0, 0.0, heights[2] / 2.0 + config.pad_gap])
    yaw = _level_yaw(X_WB)
    return [Pose(p_WT, multiply(from_yaw(yaw + n * np.pi / 2), POINTING_DOWN)) for n in range(4)]


def placements(
    placed: PlacedBox, box: OrderBox, X_TB: Pose, X_WD: Pose, config: ToolPoseConfig
) -> list[Pose]:
    """Tool poses X_WT, looking down, at which the gripped box is released over its place on deck D."""
    p_WB = X_WD.apply(placed.centre) + np.array([0.0, 0.0, config.drop])
    poses = [
        Pose(p_WB, multiply(X_WD.q, q_DB)) @ X_TB.inverse()
        for q_DB in box_orientations(box.dims, [float(edge) for edge in placed.size])
    ]
    return [X_WT for X_WT in poses if points_along(X_WT, DOWN)]


def stands(box: OrderBox, X_TB: Pose, cell: PalletizingCell, config: ToolPoseConfig) -> list[Stand]:
    """Ways to stand the box up at an edge of table B, so that its height is that on the pallet.

    The tool comes in horizontally, away from the arm; the gripped face looks back at it, a little
    before the table's edge, so that the wrist hangs in front of the table and never over it.
    """
    height = box.turn.extents[2]
    found = []
    for q_WB in box_orientations(box.dims, [None, None, height]):
        for axis in (0, 1):
            approach = _away_from_arm(cell, axis)
            level = Pose(_standing_place(box, q_WB, axis, cell, config), q_WB)
            X_WB = cell.reorientation_table.displaced(level)
            X_WT = X_WB @ X_TB.inverse()
            if points_along(X_WT, approach):
                found.append(Stand(X_WB, X_WT, approach))
    return found


def _standing_place(
    box: OrderBox, q_WB: Array, axis: int, cell: PalletizingCell, config: ToolPoseConfig
) -> Array:
    """The middle `(3,)` [m] of a box that stands at the table's edge, at the corner nearest to the arm.

    Along the approach axis it stands over the edge by `overhang`, or less so that its middle stays
    `overhang_margin` behind the edge; along the other axis it stands `inset` from the corner.
    """
    table, edges = cell.reorientation_table, np.abs(to_matrix(q_WB)) @ np.array(box.dims)
    p_WB = np.empty(3)
    p_WB[2] = table.height + edges[2] / 2.0 + config.drop
    for i in (0, 1):
        away = _away_from_arm(cell, i)[i]
        edge = table.centre[i] - away * table.size[i] / 2.0
        overhang = min(config.overhang, edges[i] / 2.0 - config.overhang_margin)
        inside = edges[i] / 2.0 + (-overhang if i == axis else config.inset)
        p_WB[i] = edge + away * inside
    return p_WB


def _away_from_arm(cell: PalletizingCell, axis: int) -> Array:
    """Unit vector along the world's x or y from the arm to table B."""
    direction = np.zeros(3)
    direction[axis] = np.sign(cell.reorientation_table.centre[axis] - cell.arm.base[axis])
    return direction


def _level_yaw(X_WB: Pose) -> float:
    """Yaw [rad] of the box's edges in the horizontal plane: the yaw of its axis that is nearest to level."""
    R_WB = to_matrix(X_WB.q)
    level = int(np.argmin(np.abs(R_WB[2])))
    return float(np.arctan2(R_WB[1, level], R_WB[0, level]))


def placed_pose(placed: PlacedBox, box: OrderBox, X_WP: Pose, X_WB: Pose | None) -> Pose:
    """The pose of a box at its place; of its equivalent orientations, the one nearest to X_WB."""
    poses = [
        Pose(X_WP.apply(placed.centre), multiply(X_WP.q, q_PB))
        for q_PB in box_orientations(box.dims, [float(edge) for edge in placed.size])
    ]
    q_WB = poses[0].q if X_WB is None else X_WB.q
    return min(poses, key=lambda pose: float(angle_between(pose.q, q_WB)))
