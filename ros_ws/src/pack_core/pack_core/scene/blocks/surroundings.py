"""What only pictures need: table top, floor, sky and lights."""

from __future__ import annotations

import mujoco

from pack_core.cells.blocks import BlocksCell

THICKNESS = 0.04
ROOM_FLOOR = -0.75


def add_surroundings(spec: mujoco.MjSpec, cell: BlocksCell) -> None:
    """Add a table top, a floor, a sky and soft light from above."""
    visual = spec.visual
    visual.quality.shadowsize = 4096
    visual.headlight.ambient = (0.42, 0.42, 0.42)
    visual.headlight.diffuse = (0.2, 0.2, 0.2)
    visual.headlight.specular = (0.0, 0.0, 0.0)
    visual.map.shadowclip = 1.4
    visual.map.znear, visual.map.zfar = 0.02, 30.0
    _add_textures(spec)
    (x, y), (length, width) = cell.table.centre, cell.table.size
    draw = dict(type=mujoco.mjtGeom.mjGEOM_BOX, contype=0, conaffinity=0)
    spec.worldbody.add_geom(pos=(x, y, -THICKNESS / 2 - 0.0005), material="table",
                            size=(length / 2, width / 2, THICKNESS / 2), **draw)  # fmt: skip
    for sx in (-1, 1):
        for sy in (-1, 1):
            spec.worldbody.add_geom(
                pos=(x + sx * (length / 2 - 0.05), y + sy * (width / 2 - 0.05), (ROOM_FLOOR - THICKNESS) / 2),
                size=(0.03, 0.03, (-ROOM_FLOOR - THICKNESS) / 2), rgba=(0.35, 0.36, 0.38, 1), **draw,
            )  # fmt: skip
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(5, 5, 0.1), pos=(0, 0, ROOM_FLOOR), material="floor",
        contype=0, conaffinity=0,
    )  # fmt: skip
    _add_lights(spec, cell)


def _add_lights(spec: mujoco.MjSpec, cell: BlocksCell) -> None:
    x, y = cell.workspace.centre
    for position, direction, bright, shadow in (
        ((x + 0.7, y - 0.9, 2.5), (-0.3, 0.4, -1.0), 0.40, True),
        ((x - 1.0, y + 1.2, 2.0), (0.5, -0.6, -1.0), 0.15, False),
    ):
        spec.worldbody.add_light(
            pos=position, dir=direction, castshadow=shadow, diffuse=(bright,) * 3, specular=(0.1,) * 3,
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
    floor = spec.add_material(name="floor", texrepeat=(6, 6), texuniform=True, reflectance=0.0)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    spec.add_material(name="table", rgba=(0.62, 0.52, 0.40, 1.0), specular=0.05, shininess=0.1)
