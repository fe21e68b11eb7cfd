"""What only pictures need: table top, floor, sky and lights."""

from __future__ import annotations

import mujoco

from pack_core.scene.scene import Container

TABLE_THICKNESS = 0.04
ROOM_FLOOR = -0.75


def add_surroundings(spec: mujoco.MjSpec, container: Container) -> None:
    """Add a table, a floor, a sky and lights that cast soft shadows."""
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.visual.quality.shadowsize = 4096
    spec.visual.headlight.ambient = (0.34, 0.34, 0.34)
    spec.visual.headlight.diffuse = (0.25, 0.25, 0.25)
    spec.visual.headlight.specular = (0.0, 0.0, 0.0)
    spec.visual.map.shadowclip = 1.4
    _add_textures(spec)
    _draw_box(
        spec, (0.35, 0, -TABLE_THICKNESS / 2 - 0.0005), (0.75, 0.6, TABLE_THICKNESS / 2), material="table"
    )
    for x in (-0.3, 1.0):
        for y in (-0.5, 0.5):
            _draw_box(
                spec, (x, y, ROOM_FLOOR / 2 - TABLE_THICKNESS / 2), (0.03, 0.03, -ROOM_FLOOR / 2 - 0.02)
            )
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(5, 5, 0.1), pos=(0, 0, ROOM_FLOOR), material="floor",
        contype=0, conaffinity=0,
    )  # fmt: skip
    x, y = container.centre
    for position, direction, bright, shadow in (
        ((x + 0.6, y - 0.8, 2.5), (-0.35, 0.4, -1.0), 0.42, True),
        ((x - 1.0, y + 1.2, 2.0), (0.5, -0.6, -1.0), 0.16, False),
    ):
        spec.worldbody.add_light(
            pos=position, dir=direction, castshadow=shadow, diffuse=(bright,) * 3, specular=(0.15,) * 3,
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        )  # fmt: skip


def _add_textures(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.95, 0.96, 0.98), rgb2=(0.70, 0.76, 0.82), width=256, height=256,
    )  # fmt: skip
    spec.add_texture(
        name="tiles", type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE, markrgb=(0.62, 0.63, 0.65), rgb1=(0.70, 0.71, 0.73),
        rgb2=(0.70, 0.71, 0.73), width=256, height=256,
    )  # fmt: skip
    floor = spec.add_material(name="floor", texrepeat=(6, 6), texuniform=True, reflectance=0.03)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    spec.add_material(name="table", rgba=(0.80, 0.76, 0.70, 1.0), specular=0.1, shininess=0.2)


def _draw_box(
    spec: mujoco.MjSpec, pos: tuple[float, ...], size: tuple[float, ...], material: str = ""
) -> None:
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, pos=pos, size=size, material=material, contype=0, conaffinity=0,
    )  # fmt: skip
