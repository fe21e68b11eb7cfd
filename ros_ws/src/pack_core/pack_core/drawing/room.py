"""Parts of the room around a cell, which only pictures need: sky, floor, table and lights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco

from pack_core.rotations import Array

THICKNESS = 0.04
"""Thickness of a table's top [m]."""
FLOOR = -0.75
"""Height of the floor under a table [m]."""
LEG, INSET = 0.03, 0.05
"""Half the width of a table's legs, and how far their middles are inside its edges [m]."""
Colour = tuple[float, float, float]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """A directional light: where it hangs [m], where it shines, how bright, and whether it casts shadows."""

    position: Point
    direction: Point
    bright: float
    shadow: bool


def add_sky(spec: mujoco.MjSpec, horizon: Colour, zenith: Colour) -> None:
    """Add a sky whose colour goes over from horizon to zenith."""
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=horizon, rgb2=zenith, width=256, height=256,
    )  # fmt: skip


def add_tiles(
    spec: mujoco.MjSpec, name: str, colour: Colour, joints: Colour, *,
    pixels: int = 256, repeat: float = 6.0, reflectance: float = 0.0,
) -> None:  # fmt: skip
    """Add a material `name` of tiles with visible joints, `repeat` tiles per metre."""
    spec.add_texture(
        name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE, markrgb=joints, rgb1=colour, rgb2=colour,
        width=pixels, height=pixels,
    )  # fmt: skip
    material = spec.add_material(
        name=name, texrepeat=(repeat, repeat), texuniform=True, reflectance=reflectance
    )
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name


def add_table(
    spec: mujoco.MjSpec,
    centre: Sequence[float] | Array,
    size: Sequence[float] | Array,
    *,
    top: str,
    floor: str,
) -> None:
    """Add a table whose top ends at z = 0, and the floor on which it stands, of these materials."""
    (x, y), (length, width) = centre, size
    # Drawn only, and half a millimetre low, so that what lies at z = 0 covers it.
    draw = dict(type=mujoco.mjtGeom.mjGEOM_BOX, contype=0, conaffinity=0)
    spec.worldbody.add_geom(
        pos=(x, y, -THICKNESS / 2 - 0.0005), size=(length / 2, width / 2, THICKNESS / 2), material=top, **draw
    )
    for sx in (-1, 1):
        for sy in (-1, 1):
            spec.worldbody.add_geom(
                pos=(x + sx * (length / 2 - INSET), y + sy * (width / 2 - INSET), (FLOOR - THICKNESS) / 2),
                size=(LEG, LEG, (-FLOOR - THICKNESS) / 2), rgba=(0.35, 0.36, 0.38, 1), **draw,
            )  # fmt: skip
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(5, 5, 0.1), pos=(0, 0, FLOOR), material=floor,
        contype=0, conaffinity=0,
    )  # fmt: skip


def add_lights(spec: mujoco.MjSpec, lights: Sequence[Light], *, specular: float) -> None:
    """Add lights, all with the same specular part."""
    for light in lights:
        spec.worldbody.add_light(
            pos=light.position, dir=light.direction, castshadow=light.shadow, diffuse=(light.bright,) * 3,
            specular=(specular,) * 3, type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        )  # fmt: skip
