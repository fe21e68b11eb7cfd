"""The obstacles of the arm, and those it may touch: furniture, and boxes at their estimated poses."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import BoxTable, PalletizingCell, PalletPlace
from pack_core.palletizing.orders.order import OrderBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Pose
from pallet_fsm.states import Place

PICKING_TABLE = "picking_table"
REORIENTATION_TABLE = "reorientation_table"
PALLET = "pallet"
TABLES = {Place.TABLE_A: PICKING_TABLE, Place.TABLE_B: REORIENTATION_TABLE}
"""Name of the obstacle of each table on which boxes are gripped."""
BESIDE = 0.02
"""Boxes nearer to a place than this may be touched when a box is put there [m]."""


def furniture(cell: PalletizingCell) -> tuple[Obstacle, ...]:
    """Tables and pallet, each as a block down to the floor."""
    return (
        _block(PICKING_TABLE, cell.picking_table),
        _block(REORIENTATION_TABLE, cell.reorientation_table),
        _block(PALLET, cell.pallet),
    )


def standing_box(box: OrderBox, X_WB: Pose) -> Obstacle:
    """The obstacle of a box that stands at X_WB."""
    return Obstacle(box.id, X_WB, np.array(box.dims))


def neighbours(placed: PlacedBox, others: Mapping[str, PlacedBox]) -> frozenset[str]:
    """Names of the pallet and of the boxes that are next to a place, over it or under it."""
    near = {name for name, other in others.items() if np.all(placed.clearance(other) < BESIDE)}
    return frozenset(near - {placed.id}) | {PALLET}


def _block(name: str, place: BoxTable | PalletPlace) -> Obstacle:
    x, y, height = place.middle
    X_WO = place.displaced(Pose(np.array([x, y, height / 2.0])))
    return Obstacle(name, X_WO, np.array([*place.size, height]))
