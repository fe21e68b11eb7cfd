"""The MuJoCo model of the palletizing cell with its boxes, and what viewers are told of it."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import BoxContact, PalletizingCell
from pack_core.palletizing.furniture import add_belts, add_furniture, add_surroundings
from pack_core.palletizing.scanner import scanner_frame
from pack_core.palletizing.visitors import Visitor
from pack_core.robots.joint_properties import Gears
from pack_core.robots.kr210 import ARM_BITS, LIMITS, add_kr210
from pack_core.robots.surface_gripper import TOOL
from pack_core.robots.urdf import DescribedRobot
from pack_core.rotations import Pose

GRIP_SOLREF = (0.01, 1.0)
GRIP_SOLIMP = (0.95, 0.99, 0.001, 0.5, 2.0)
"""Compliance of the grip's weld, in MuJoCo's solver parameters: a box of 15 kg sags by 0.06 mm."""


def build_model(
    cell: PalletizingCell,
    boxes: Sequence[BoxBody] = (),
    *,
    timestep: float = 0.002,
    visuals: bool = False,
    X_WB: Pose | None = None,
    gears: Gears | None = None,
    visitors: Sequence[Visitor] = (),
) -> mujoco.MjModel:
    """Compile the cell.

    Args:
        cell: the cell's physical facts.
        boxes: boxes in the order of their arrival; a model with one more box has the same first coordinates.
        timestep: step of the integrator [s].
        visuals: whether shapes, textures and lights for pictures are added.
        X_WB: true pose of the arm's base; by default the nominal one.
        gears: elastic gears; by default rigid ones.
        visitors: who comes near the arm; each is a mocap body and a geom of its name.

    Returns:
        The model. Arm joints and their motors carry the names of `LIMITS`, the tool is body `tool`; every
        box is a body, a free joint, a geom and an inactive weld to the tool, all of its name.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    _set_solver(spec, cell.contact, timestep)
    add_furniture(spec, cell, visuals=visuals)
    flange = add_kr210(spec, X_WB or cell.arm.X_WB, visuals=visuals, gears=gears)
    cell.tool.add_to(flange, visuals=visuals)
    add_belts(spec, cell, visuals=visuals)
    _add_motors(spec)
    for visitor in visitors:
        _add_visitor(spec, visitor)
    for box in boxes:
        add_box(spec, box)
    _set_contacts(spec, cell.contact)
    if visuals:
        add_surroundings(spec, cell)
    return spec.compile()


def add_box(spec: mujoco.MjSpec, box: BoxBody) -> None:
    """Add a free box and the weld that holds it to the tool once it is gripped.

    Its contacts resist rolling (`condim` 6), if little: without that boxes on each other may rock without
    end, and walk by a millimetre a second.
    """
    body = spec.worldbody.add_body(name=box.name)
    body.add_freejoint(name=box.name)
    body.add_geom(
        name=box.name, type=mujoco.mjtGeom.mjGEOM_BOX, size=box.half_extents, mass=box.mass,
        contype=1, conaffinity=1 | ARM_BITS, condim=6, rgba=(0.72, 0.55, 0.36, 1.0),
    )  # fmt: skip
    spec.add_equality(
        name=box.name, type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY, name1=TOOL,
        name2=box.name, active=False, solref=GRIP_SOLREF, solimp=GRIP_SOLIMP,
    )  # fmt: skip


def _add_visitor(spec: mujoco.MjSpec, visitor: Visitor) -> None:
    """Add a capsule that is moved from outside and gives way to nothing."""
    start = visitor.at(0.0).X_WV
    body = spec.worldbody.add_body(name=visitor.name, mocap=True, pos=start.p, quat=start.q)
    body.add_geom(
        name=visitor.name, type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=(visitor.radius, visitor.length / 2, 0),
        contype=1, conaffinity=1 | ARM_BITS, condim=3, rgba=(0.95, 0.45, 0.1, 0.8),
    )  # fmt: skip


def _add_motors(spec: mujoco.MjSpec) -> None:
    """A torque actuator on every joint, with the published limit; controls are torques `(6,)` [N m]."""
    for name, limit in zip(LIMITS.names, LIMITS.effort, strict=True):
        spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            ctrllimited=True,
            ctrlrange=(-limit, limit),
        ).set_to_motor()


def _set_solver(spec: mujoco.MjSpec, contact: BoxContact, timestep: float) -> None:
    option = spec.option
    option.timestep = timestep
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # MuJoCo 4.0.0 may diverge with the sparse one (#3767)
    option.impratio = 10.0
    option.noslip_iterations = contact.noslip_iterations
    if contact.sleep_speed > 0.0:
        option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        option.sleep_tolerance = contact.sleep_speed


def _set_contacts(spec: mujoco.MjSpec, contact: BoxContact) -> None:
    for geom in spec.geoms:
        geom.friction = (contact.friction, 0.005, 0.0001)
        geom.solref, geom.solimp = contact.solref, (*contact.solimp, 0.5, 2.0)


def describe_robot(cell: PalletizingCell) -> DescribedRobot:
    """The arm on its nominal base, with rigid gears, and the gripper; its face is the link `tool`."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    cell.tool.add_to(add_kr210(spec, cell.arm.X_WB, visuals=True), visuals=True)
    return DescribedRobot.of(spec, "kr210", LIMITS)


def fixed_frames(cell: PalletizingCell) -> dict[str, tuple[str, Pose]]:
    """X_PF and the parent's name P, by the name of frame F.

    `pallet_deck` is the frame of orders and layouts: a corner of the deck, x along its length.
    `overhead_camera` is that of the pictures, each scanner has its own: z forward, x to the right, y down.
    """
    return {
        "pallet_deck": ("world", cell.pallet.X_WP),
        "overhead_camera": ("world", cell.overhead_camera.X_WC),
    } | {scanner_frame(place): ("world", cell.scanner_pose(place)) for place in cell.scanned}
