"""Tables, pallet and floor of the palletizing cell."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.palletizing.cell import BoxTable, PalletizingCell, PalletPlace
from pack_core.robots.kr210 import ARM_BITS
from pack_core.rotations import Pose

BOX = mujoco.mjtGeom.mjGEOM_BOX
SOLID = {"contype": 1, "conaffinity": 1 | ARM_BITS, "condim": 3}
"""Contact bits of a geom that boxes and the arm collide with."""
DRAWN = {"contype": 0, "conaffinity": 0, "mass": 0}
TOP = 0.05
"""Thickness of a table's top [m]."""
LEG = 0.04
BOARD = 0.022

RUBBER = (0.15, 0.16, 0.17, 1.0)
FRAME = (0.35, 0.38, 0.42, 1.0)
WOOD = (0.76, 0.62, 0.42)


def add_furniture(spec: mujoco.MjSpec, cell: PalletizingCell, *, look: bool) -> None:
    """Add what stands still: bodies `floor`, `picking_table`, `reorientation_table` and `pallet`."""
    floor = spec.worldbody.add_body(name="floor")
    floor.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(8, 8, 0.1), rgba=(0.6, 0.6, 0.6, 1), **SOLID
    )
    for name in ("picking_table", "reorientation_table"):
        _add_table(spec, name, getattr(cell, name), look=look)
    _add_pallet(spec, cell.pallet, look=look)


def _add_table(spec: mujoco.MjSpec, name: str, table: BoxTable, *, look: bool) -> None:
    X_WT = table.displaced(Pose(table.middle))
    body = spec.worldbody.add_body(name=name, pos=X_WT.p, quat=X_WT.q)
    x, y = 0.5 * np.array(table.size)
    body.add_geom(name=name, type=BOX, pos=(0, 0, -TOP / 2), size=(x, y, TOP / 2), rgba=RUBBER, **SOLID)
    if not look:
        return
    leg = (table.height - TOP) / 2
    for sign_x in (-1, 1):
        for sign_y in (-1, 1):
            pos = (sign_x * (x - LEG), sign_y * (y - LEG), -TOP - leg)
            body.add_geom(type=BOX, pos=pos, size=(LEG, LEG, leg), rgba=FRAME, **DRAWN)
        body.add_geom(type=BOX, pos=(sign_x * (x - LEG), 0, -TOP - LEG), size=(LEG / 2, y - 2 * LEG, LEG),
                      rgba=FRAME, **DRAWN)  # fmt: skip


def _add_pallet(spec: mujoco.MjSpec, pallet: PalletPlace, *, look: bool) -> None:
    """A solid block for contacts; boards and blocks that are only drawn."""
    (l, w), h = 0.5 * np.array(pallet.size), pallet.deck_height
    x, y = pallet.corner
    X_WD = pallet.displaced(Pose(np.array([x + l, y + w, 0.0])))
    body = spec.worldbody.add_body(name="pallet", pos=X_WD.p, quat=X_WD.q)
    body.add_geom(name="pallet", type=BOX, pos=(0, 0, h / 2), size=(l, w, h / 2),
                  rgba=(*WOOD, float(not look)), **SOLID)  # fmt: skip
    if not look:
        return
    wood = {"type": BOX, "material": "wood", **DRAWN}
    for width, offset in ((0.145, -1.0), (0.145, 1.0), (0.145, 0.0), (0.1, -0.5), (0.1, 0.5)):
        y = offset * (w - 0.0725)
        body.add_geom(pos=(0, y, h - BOARD / 2), size=(l, width / 2, BOARD / 2), **wood)
    for x in (-l + 0.0725, 0.0, l - 0.0725):
        body.add_geom(pos=(x, 0, h - 1.5 * BOARD), size=(0.0725, w, BOARD / 2), **wood)
        for y in (-w + 0.0725, 0.0, w - 0.0725):
            body.add_geom(pos=(x, y, (h - BOARD) / 2), size=(0.0725, 0.05, (h - 3 * BOARD) / 2), **wood)
    for y in (-w + 0.05, 0.0, w - 0.05):
        body.add_geom(pos=(0, y, BOARD / 2), size=(l, 0.05, BOARD / 2), **wood)
