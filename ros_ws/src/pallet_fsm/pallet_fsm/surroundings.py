"""What the arm must not touch, and what it may: furniture, and boxes where they are believed to stand."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import BoxTable, PalletizingCell
from pack_core.palletizing.orders.order import OrderBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array, Pose
from pallet_fsm.states import Place

PICKING_TABLE = "picking_table"
REORIENTATION_TABLE = "reorientation_table"
PALLET = "pallet"
TABLES = {Place.TABLE_A: PICKING_TABLE, Place.TABLE_B: REORIENTATION_TABLE}
"""Names of what boxes are gripped on."""
BESIDE = 0.02
"""Boxes this near to a place [m] are touched, or nearly, when a box goes there."""


def furniture(cell: PalletizingCell) -> tuple[Obstacle, ...]:
    """Tables and pallet, each as a block down to the floor."""
    pallet = cell.pallet
    centre = (pallet.corner[0] + pallet.size[0] / 2.0, pallet.corner[1] + pallet.size[1] / 2.0)
    return (
        _table(PICKING_TABLE, cell.picking_table),
        _table(REORIENTATION_TABLE, cell.reorientation_table),
        _block(PALLET, centre, pallet.size, pallet.deck_height),
    )


def standing_box(box: OrderBox, X_WB: Pose) -> Obstacle:
    """A box where it stands."""
    return Obstacle(box.id, X_WB, np.array(box.dims))


def neighbours(placed: PlacedBox, others: Mapping[str, PlacedBox]) -> frozenset[str]:
    """Names of the pallet and of the boxes next to a place, over it or under it."""
    near = {name for name, other in others.items() if np.all(placed.clearance(other) < BESIDE)}
    return frozenset(near - {placed.id}) | {PALLET}


def _table(name: str, table: BoxTable) -> Obstacle:
    return _block(name, table.centre, table.size, table.height)


def _block(
    name: str, centre: tuple[float, float], size: tuple[float, float] | Array, height: float
) -> Obstacle:
    return Obstacle(name, Pose(np.array([*centre, height / 2.0])), np.array([*size, height]))
