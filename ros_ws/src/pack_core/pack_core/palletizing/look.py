"""The parts of the palletizing cell that only pictures need: materials, lights, sky, marks on the floor."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.palletizing.calibration_board import CALIBRATION_BOARD, board_faces
from pack_core.palletizing.cardboard import FACE_PIXELS, cardboard_faces
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.wood import wood_picture
from pack_core.room import Light, add_lights, add_sky, add_tiles

CARDBOARDS = 8
"""Number of different cardboard materials."""
BOARD = "calibration_board"
RGB = mujoco.mjtTextureRole.mjTEXROLE_RGB


def add_surroundings(spec: mujoco.MjSpec, cell: PalletizingCell) -> None:
    """Add a floor, a sky, lights that cast shadows, and materials for boxes: `cardboard_0`, ..."""
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = cell.camera.width, cell.camera.rows
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
    _add_picture(spec, "wood", wood_picture(np.random.default_rng(1)))
    for i in range(CARDBOARDS):
        _add_cardboard(spec, f"cardboard_{i}", np.random.default_rng(i))
    _add_board(spec)


def _add_board(spec: mujoco.MjSpec) -> None:
    """The calibration board's material: the pattern on its upper face, cardboard brown elsewhere."""
    faces = board_faces(CALIBRATION_BOARD)
    texture = spec.add_texture(
        name=BOARD, type=mujoco.mjtTexture.mjTEXTURE_CUBE, width=faces.shape[1], height=faces.shape[0],
        nchannel=3,
    )  # fmt: skip
    texture.data = faces.tobytes()
    material = spec.add_material(name=BOARD, specular=0.0, shininess=0.0)
    material.textures[RGB] = BOARD


def _add_picture(spec: mujoco.MjSpec, name: str, picture: np.ndarray) -> None:
    height, width, _ = picture.shape
    texture = spec.add_texture(
        name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=width, height=height, nchannel=3
    )
    texture.data = picture.tobytes()
    material = spec.add_material(name=name, specular=0.05, shininess=0.1)
    material.textures[RGB] = name


def _add_cardboard(spec: mujoco.MjSpec, name: str, rng: np.random.Generator) -> None:
    faces = cardboard_faces(rng)
    texture = spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_CUBE,
        width=FACE_PIXELS,
        height=6 * FACE_PIXELS,
        nchannel=3,
    )
    texture.data = faces.tobytes()
    material = spec.add_material(name=name, specular=0.03, shininess=0.05)
    material.textures[RGB] = name


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
