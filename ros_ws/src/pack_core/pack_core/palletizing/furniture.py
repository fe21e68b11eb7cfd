"""Tables, pallet and floor of the palletizing cell; for pictures also materials, lights, sky and marks."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.drawing.room import Light, add_lights, add_sky, add_tiles
from pack_core.drawing.textures import add_material, cardboard_faces, wood_picture
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD, board_face
from pack_core.palletizing.cell import (
    PICKING_TABLE,
    QUEUE_BELT,
    REJECT_TABLE,
    REORIENTATION_TABLE,
    BoxTable,
    PalletizingCell,
    PalletPlace,
)
from pack_core.robots.kr210 import ARM_BITS
from pack_core.rotations import Pose

BOX = mujoco.mjtGeom.mjGEOM_BOX
SOLID = {"contype": 1, "conaffinity": 1 | ARM_BITS, "condim": 3}
"""Contact bits of a geom that boxes and the arm collide with."""
DRAWN = {"contype": 0, "conaffinity": 0, "mass": 0}
"""Of a geom that is drawn alone."""
TOP = 0.05
"""Thickness of a table's top [m]."""
LEG = 0.04
"""Half the width of a table's legs [m]."""
PLANK = 0.022
"""Thickness of the pallet's planks [m]."""

RUBBER = (0.15, 0.16, 0.17, 1.0)
FRAME = (0.35, 0.38, 0.42, 1.0)
WOOD = (0.76, 0.62, 0.42)
"""Colours: red, green, blue, and opacity where it is fixed."""
CARDBOARDS = 8
"""Number of different cardboard materials."""
BOARD = "calibration_board"
BELT_MASS = 500.0
"""Of a belt with all that turns with it: boxes do not slow it down within a step of the physics [kg]."""


def add_furniture(spec: mujoco.MjSpec, cell: PalletizingCell, *, visuals: bool) -> None:
    """Add what stands still: bodies `floor`, `pallet` and the tables, each of the name of its place."""
    floor = spec.worldbody.add_body(name="floor")
    floor.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(8, 8, 0.1), rgba=(0.6, 0.6, 0.6, 1), **SOLID
    )
    is_conveyor = cell.shift is not None  # then table A is a belt, which comes behind the arm's joints
    tables = (REORIENTATION_TABLE, REJECT_TABLE) if is_conveyor else (PICKING_TABLE, REORIENTATION_TABLE)
    for name in tables:
        _add_table(spec, name, cell.place(name), visuals=visuals)
    for name in cell.pallets:
        _add_pallet(spec, name, cell.place(name), visuals=visuals)


def add_belts(spec: mujoco.MjSpec, cell: PalletizingCell, *, visuals: bool) -> None:
    """Add the belts of the infeed, if the cell has one: bodies `picking_table` and `queue_belt`.

    Each is a body on a slide of its own name along x. Whoever steps the physics gives the slide the belt's
    speed and puts it back to 0 in every step: friction then acts as under a belt that goes round.
    """
    if cell.shift is None:
        return
    for name, table in ((PICKING_TABLE, cell.picking_table), (QUEUE_BELT, cell.queue_belt)):
        body = _add_table(spec, name, table, visuals=visuals)
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(1, 0, 0))
        body.explicitinertial = True
        body.mass, body.inertia, body.ipos = BELT_MASS, (BELT_MASS,) * 3, (0.0, 0.0, 0.0)
        body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER


def _add_table(
    spec: mujoco.MjSpec, name: str, table: BoxTable | PalletPlace, *, visuals: bool
) -> mujoco.MjsBody:
    X_WT = table.displaced(Pose(table.middle))
    body = spec.worldbody.add_body(name=name, pos=X_WT.p, quat=X_WT.q)
    x, y = 0.5 * np.array(table.size)
    body.add_geom(name=name, type=BOX, pos=(0, 0, -TOP / 2), size=(x, y, TOP / 2), rgba=RUBBER, **SOLID)
    if not visuals:
        return body
    leg = (table.middle[2] - TOP) / 2
    for sign_x in (-1, 1):
        for sign_y in (-1, 1):
            pos = (sign_x * (x - LEG), sign_y * (y - LEG), -TOP - leg)
            body.add_geom(type=BOX, pos=pos, size=(LEG, LEG, leg), rgba=FRAME, **DRAWN)
        body.add_geom(type=BOX, pos=(sign_x * (x - LEG), 0, -TOP - LEG), size=(LEG / 2, y - 2 * LEG, LEG),
                      rgba=FRAME, **DRAWN)  # fmt: skip
    return body


def _add_pallet(spec: mujoco.MjSpec, name: str, pallet: BoxTable | PalletPlace, *, visuals: bool) -> None:
    """A solid block for contacts; boards and blocks that are only drawn."""
    (l, w), h = 0.5 * np.array(pallet.size), float(pallet.middle[2])
    X_WD = pallet.displaced(Pose(np.array([*pallet.middle[:2], 0.0])))
    body = spec.worldbody.add_body(name=name, pos=X_WD.p, quat=X_WD.q)
    body.add_geom(name=name, type=BOX, pos=(0, 0, h / 2), size=(l, w, h / 2),
                  rgba=(*WOOD, float(not visuals)), **SOLID)  # fmt: skip
    if not visuals:
        return
    wood = {"type": BOX, "material": "wood", **DRAWN}
    for width, offset in ((0.145, -1.0), (0.145, 1.0), (0.145, 0.0), (0.1, -0.5), (0.1, 0.5)):
        y = offset * (w - 0.0725)
        body.add_geom(pos=(0, y, h - PLANK / 2), size=(l, width / 2, PLANK / 2), **wood)
    for x in (-l + 0.0725, 0.0, l - 0.0725):
        body.add_geom(pos=(x, 0, h - 1.5 * PLANK), size=(0.0725, w, PLANK / 2), **wood)
        for y in (-w + 0.0725, 0.0, w - 0.0725):
            body.add_geom(pos=(x, y, (h - PLANK) / 2), size=(0.0725, 0.05, (h - 3 * PLANK) / 2), **wood)
    for y in (-w + 0.05, 0.0, w - 0.05):
        body.add_geom(pos=(0, y, PLANK / 2), size=(l, 0.05, PLANK / 2), **wood)


def add_surroundings(spec: mujoco.MjSpec, cell: PalletizingCell) -> None:
    """Add a floor, a sky, lights that cast shadows, and materials for boxes: `cardboard_0`, ..."""
    visual = spec.visual
    visual.quality.shadowsize = 4096
    visual.headlight.ambient = (0.36, 0.36, 0.36)
    visual.headlight.diffuse, visual.headlight.specular = (0.20, 0.20, 0.20), (0.0, 0.0, 0.0)
    visual.map.shadowclip = 2.0
    visual.map.znear, visual.map.zfar = 0.01, 20.0
    _add_materials(spec)
    spec.geom("floor").material = "concrete"
    _add_marks(spec, cell)
    lights = (
        Light((-3.5, -1.0, 5.0), (0.35, 0.35, -1.0), 0.46, True),
        Light((1.5, 4.0, 4.0), (-0.5, -0.5, -1.0), 0.16, False),
    )
    add_lights(spec, lights, specular=0.1)


def _add_materials(spec: mujoco.MjSpec) -> None:
    add_sky(spec, (0.94, 0.95, 0.97), (0.66, 0.72, 0.79))
    add_tiles(
        spec, "concrete", (0.80, 0.81, 0.82), (0.70, 0.71, 0.72), pixels=512, repeat=0.5, reflectance=0.02
    )
    add_material(spec, "wood", wood_picture(np.random.default_rng(1)), specular=0.05, shininess=0.1)
    for i in range(CARDBOARDS):
        faces = cardboard_faces(np.random.default_rng(i))
        add_material(spec, f"cardboard_{i}", faces, specular=0.03, shininess=0.05)
    add_material(spec, BOARD, board_face(CALIBRATION_BOARD), specular=0.0, shininess=0.0)


def _add_marks(spec: mujoco.MjSpec, cell: PalletizingCell) -> None:
    """Yellow tape on the floor around the pallet's place and the cell."""
    (x, y), (l, w) = cell.pallet.corner, cell.pallet.size
    for x_0, y_0, x_1, y_1 in ((x - 0.15, y - 0.15, x + l + 0.15, y + w + 0.15), (-4.0, -0.9, 1.4, 4.0)):
        centre, half = ((x_0 + x_1) / 2, (y_0 + y_1) / 2), ((x_1 - x_0) / 2, (y_1 - y_0) / 2)
        for side in (-1, 1):
            _add_stripe(spec, (centre[0], centre[1] + side * half[1]), (half[0] + 0.025, 0.025))
            _add_stripe(spec, (centre[0] + side * half[0], centre[1]), (0.025, half[1]))


def _add_stripe(spec: mujoco.MjSpec, centre: tuple[float, float], half: tuple[float, float]) -> None:
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, pos=(*centre, 0.001), size=(*half, 0.001), rgba=(0.93, 0.75, 0.10, 1),
        contype=0, conaffinity=0,
    )  # fmt: skip
