"""MuJoCo model of the blocks cell: arm, gripper, table, blocks and camera; what viewers are told of it."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.problem import CUBES, BlockSize, BlockSizes
from pack_core.drawing.room import Light, add_lights, add_sky, add_table, add_tiles
from pack_core.drawing.textures import add_material, cube_faces
from pack_core.robots.robotiq_2f85 import PADS, TIPS, add_robotiq_2f85
from pack_core.robots.ur10e import LIMITS, add_motors, add_ur10e
from pack_core.robots.urdf import DescribedRobot
from pack_core.rotations import Pose

CAMERA = "overhead"
TOOL = "tool"
ROBOT, THINGS = 1, 2
"""Bits of contact: the robot touches things and never itself, things touch one another."""
ROTATION = (0.01, 0.0005)
"""Torsional and rolling friction [m]."""


def block_name(block: str) -> str:
    """Name of a block's body, free joint and geom, from its id."""
    return f"block {block}"


def build_model(
    cell: BlocksCell,
    tags: Mapping[str, int],
    sizes: BlockSizes = CUBES,
    *,
    timestep: float,
    visuals: bool = False,
) -> mujoco.MjModel:
    """Compile the cell.

    Args:
        cell: its physical facts.
        tags: the number of every block's tag, by the block's id.
        sizes: of those blocks that are not the cell's cubes, by id.
        timestep: of the integrator [s].
        visuals: add tags, table top, room and lights, for pictures.

    Returns:
        The model; blocks are bodies with free joints, see `block_name`; the tool's frame is body `tool`.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    _set_solver(spec, cell, timestep)
    _add_table(spec, cell, visuals)
    for block, tag in tags.items():
        _add_block(spec, cell, block, sizes.get(block, cell.block.cube), tag if visuals else None)
    flange = add_ur10e(spec, cell.robot.base.to_pose(), contype=ROBOT, conaffinity=0)
    add_motors(spec)
    friction = cell.gripper.pad_friction
    add_robotiq_2f85(flange, spec, pad_friction=friction, contype=ROBOT, conaffinity=0)
    _add_camera(spec, cell)
    if visuals:
        _add_surroundings(spec, cell)
    _set_contacts(spec, cell)
    for block in tags:
        _add_grips(spec, cell, block_name(block))
    return spec.compile()


def arm_model(cell: BlocksCell) -> mujoco.MjModel:
    """The arm and its gripper alone, for kinematics."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    flange = add_ur10e(spec, cell.robot.base.to_pose(), contype=0, conaffinity=0)
    add_robotiq_2f85(flange, spec, pad_friction=1.0, contype=0, conaffinity=0)
    return spec.compile()


def _set_solver(spec: mujoco.MjSpec, cell: BlocksCell, timestep: float) -> None:
    option, contact = spec.option, cell.contact
    option.timestep = timestep
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = contact.impratio
    option.noslip_iterations = contact.noslip_iterations


def _set_contacts(spec: mujoco.MjSpec, cell: BlocksCell) -> None:
    for geom in spec.geoms:
        geom.solref, geom.solimp = cell.contact.solref, cell.contact.solimp


def _add_grips(spec: mujoco.MjSpec, cell: BlocksCell, block: str) -> None:
    """The fingers on a block: soft where they press, so that they settle, and stiff where they stick."""
    gripper, contact = cell.gripper, cell.contact
    for geoms, friction in ((PADS, gripper.pad_friction), (TIPS, gripper.tip_friction)):
        for geom in geoms:
            spec.add_pair(
                geomname1=geom, geomname2=block, condim=6,
                friction=(friction, friction, ROTATION[0], ROTATION[1], ROTATION[1]),
                solref=contact.finger_solref, solreffriction=contact.solref, solimp=contact.solimp,
            )  # fmt: skip


def _add_table(spec: mujoco.MjSpec, cell: BlocksCell, visuals: bool) -> None:
    table = cell.table
    half = 0.5 * np.array(table.size)
    spec.worldbody.add_geom(
        name="table", type=mujoco.mjtGeom.mjGEOM_PLANE, pos=(*table.centre, 0), size=(*half, 0.1),
        friction=(table.friction, *ROTATION), condim=4, contype=THINGS, conaffinity=ROBOT | THINGS,
        rgba=(0.75, 0.68, 0.58, 0.0 if visuals else 1.0),
    )  # fmt: skip


def _add_block(spec: mujoco.MjSpec, cell: BlocksCell, block: str, size: BlockSize, tag: int | None) -> None:
    name, facts = block_name(block), cell.block
    half = tuple(0.5 * edge for edge in size)
    body = spec.worldbody.add_body(name=name, pos=(0, 0, half[2]))
    body.add_freejoint(name=name)
    geom = body.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=half, mass=facts.mass_of(size), condim=4,
        friction=(facts.friction, *ROTATION), contype=THINGS, conaffinity=ROBOT | THINGS,
        rgba=(0.78, 0.64, 0.45, 1) if tag is None else (1, 1, 1, 1),
    )  # fmt: skip
    if tag is not None:
        geom.material = f"tag of {block}"
        faces = cube_faces(tag, facts.tag_edge_of(size), (size.x, size.y))
        add_material(spec, geom.material, faces, specular=0.0, shininess=0.0)


def _add_camera(spec: mujoco.MjSpec, cell: BlocksCell) -> None:
    """Looks down; MuJoCo's cameras look along -z with +y up, so that it needs no rotation."""
    camera = cell.camera
    spec.worldbody.add_camera(name=CAMERA, pos=camera.position, fovy=camera.fovy_deg)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = camera.width, camera.height


def _add_surroundings(spec: mujoco.MjSpec, cell: BlocksCell) -> None:
    """Add a table, a floor, a sky and soft light from above."""
    visual = spec.visual
    visual.quality.shadowsize = 4096
    visual.headlight.ambient = (0.42, 0.42, 0.42)
    visual.headlight.diffuse, visual.headlight.specular = (0.2, 0.2, 0.2), (0.0, 0.0, 0.0)
    visual.map.shadowclip = 1.4
    visual.map.znear, visual.map.zfar = 0.02, 30.0
    add_sky(spec, (0.95, 0.96, 0.98), (0.70, 0.76, 0.82))
    add_tiles(spec, "tiles", (0.70, 0.71, 0.73), (0.62, 0.63, 0.65))
    spec.add_material(name="table", rgba=(0.62, 0.52, 0.40, 1.0), specular=0.05, shininess=0.1)
    add_table(spec, cell.table.centre, cell.table.size, top="table", floor="tiles")
    x, y = cell.workspace.centre
    lights = (
        Light((x + 0.7, y - 0.9, 2.5), (-0.3, 0.4, -1.0), 0.40, True),
        Light((x - 1.0, y + 1.2, 2.0), (0.5, -0.6, -1.0), 0.15, False),
    )
    add_lights(spec, lights, specular=0.1)


def describe_robot(cell: BlocksCell) -> DescribedRobot:
    """The arm and the gripper with its fingers; the point between the finger tips is the link `tool`."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    flange = add_ur10e(spec, cell.robot.base.to_pose(), contype=0, conaffinity=0)
    add_robotiq_2f85(flange, spec, pad_friction=1.0, contype=0, conaffinity=0)
    return DescribedRobot.of(spec, "ur10e", LIMITS)


def fixed_frames(cell: BlocksCell) -> dict[str, tuple[str, Pose]]:
    """X_PF and the parent's name P, by the name of frame F.

    `table` is the middle of the table's top, `workspace` the middle of where blocks may be, and
    `overhead_camera` that of the pictures: z forward, x to the right, y down.
    """
    return {
        "table": ("world", Pose(np.array([*cell.table.centre, 0.0]))),
        "workspace": ("world", Pose(np.array([*cell.workspace.centre, 0.0]))),
        "overhead_camera": ("world", cell.camera.pinhole.X_WC),
    }
