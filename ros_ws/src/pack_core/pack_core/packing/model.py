"""MuJoCo models of the packing cell: one builder, with roles for the arm and for the new object."""

from __future__ import annotations

from enum import Enum

import mujoco
import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.packing.steering import add_steering
from pack_core.packing.surroundings import add_surroundings
from pack_core.packing.table_and_container import add_container, add_table
from pack_core.packing.tip import add_tip
from pack_core.robots.arm_drive import add_motors, add_servos, make_heavy
from pack_core.robots.pump import add_pump
from pack_core.rotations import Array, Pose

TIP_FORCE = "tip_force"
TIP_TORQUE = "tip_torque"
HELD_POSITION = "held_position"
HELD_X_AXIS = "held_x_axis"
HELD_Z_AXIS = "held_z_axis"
WALLS = ("wall_left", "wall_right", "wall_near", "wall_far")
UPSIDE_DOWN = (0.0, 1.0, 0.0, 0.0)
"""Half a turn about x as a quaternion wxyz: the cup's z axis points down, the held object's points up."""


class ArmRole(Enum):
    """How the arm takes part in a model."""

    ABSENT = "absent"
    DRIVEN = "driven"
    """Torque actuators on every joint."""
    SERVO = "servo"
    """The driver's position and velocity servos on every joint (Eq. 4 without feed-forward)."""
    GUIDED = "guided"
    """Heavy joints without actuators, for a caller that sets their positions and velocities."""


class HeldRole(Enum):
    """How the new object takes part in a model."""

    RIGID = "rigid"
    """Fixed to the cup, its weight compensated."""
    COMPLIANT = "compliant"
    """On the springs of the cup, its weight not compensated; for the simulator that stands for reality."""
    FREE = "free"
    """A free body that nothing holds."""
    STEERED = "steered"
    """A body of its own without weight, pulled by springs to a pose that the caller commands."""
    ABSENT = "absent"


def build_model(
    scene: Scene,
    cell: PackingCell,
    *,
    timestep: float,
    arm: ArmRole,
    held: HeldRole,
    surroundings: bool = False,
    lip_touches: bool = False,
) -> mujoco.MjModel:
    """Compile a model of the cell.

    Args:
        scene: the container and the objects; poses may be absent.
        cell: the cell's physical facts.
        timestep: step of the integrator [s].
        arm: how the arm takes part; an object that is held needs one.
        held: how the new object takes part; `HeldRole.COMPLIANT` needs a cell with a `tip`.
        surroundings: whether to add floor, table, lights and materials, for pictures.
        lip_touches: whether the empty cup collides with objects, as when it comes down on one to grip it.

    Returns:
        The model. Bodies and free joints carry the objects' names, and the cup is the body `tool`. The
        sensors `tip_force` and `tip_torque` measure the load on the cup in the frame of site `tip`. The
        sensors `held_position`, `held_x_axis` and `held_z_axis` give the held object's pose in the world.

    Raises:
        ConfigError: `held` is compliant and the cell has no `tip`.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    _set_solver(spec, timestep)
    add_table(spec, scene.friction, surroundings)
    add_container(spec, scene.container, scene.friction)
    for item in scene.objects:
        _add_object(spec, spec.worldbody.add_body(name=item.name), item, scene, free=True)
    tool = None if arm is ArmRole.ABSENT else _add_arm(spec, cell)
    if lip_touches:
        cup = spec.geom("pump_cup")
        cup.contype = cup.conaffinity = 1
    _add_new_object(spec, tool, scene, held, cell)
    if arm is ArmRole.DRIVEN:
        add_motors(spec, cell.robot.arm)
    elif arm is ArmRole.SERVO:
        add_servos(spec, cell.robot)
    elif arm is ArmRole.GUIDED:
        make_heavy(spec, cell.robot.arm)
    if surroundings:
        add_surroundings(spec, scene.container)
    return spec.compile()


def held_pose(scene: Scene) -> Pose:
    """X_TN of the held new object N on the cup T; unless told, it hangs upright by the middle of its top."""
    if scene.grip is not None:
        return scene.grip.to_pose()
    return Pose(np.array([0.0, 0.0, scene.new_object.half_extents[2]]), np.array(UPSIDE_DOWN))


def cup_point(scene: Scene) -> Array:
    """p_NT `(3,)` [m]: where on the held object N the cup T is, the middle of its top unless told."""
    if scene.grip is not None:
        return scene.grip.to_pose().inverse().p
    return np.array([0.0, 0.0, float(scene.new_object.half_extents[2])])


def _add_arm(spec: mujoco.MjSpec, cell: PackingCell) -> mujoco.MjsBody:
    """Add the cell's arm with its pump and return the cup, the body `tool`."""
    arm = cell.robot.arm
    return add_pump(arm.add_to(spec), cell.pump, arm.flange)


def _set_solver(spec: mujoco.MjSpec, timestep: float) -> None:
    option = spec.option
    option.timestep = timestep
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL
    # MuJoCo 4.0 reports some contacts between a tilted box and a cylinder far too shallow, or not at all,
    # when it looks for several at once, so that objects sink into each other by centimetres. One is exact.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_MULTICCD


def _add_new_object(
    spec: mujoco.MjSpec, tool: mujoco.MjsBody | None, scene: Scene, held: HeldRole, cell: PackingCell
) -> None:
    item = scene.new_object
    if held in (HeldRole.FREE, HeldRole.STEERED):
        is_steered = held is HeldRole.STEERED
        body = spec.worldbody.add_body(name=item.name, gravcomp=is_steered)
        _add_object(spec, body, item, scene, free=True)
        if is_steered:
            add_steering(spec, body, cell.push.force, cell.push.moment)
    elif held is not HeldRole.ABSENT and tool is not None:
        X_TN, is_rigid = held_pose(scene), held is HeldRole.RIGID
        body = tool.add_body(name=item.name, pos=X_TN.p, quat=X_TN.q, gravcomp=is_rigid)
        _add_object(spec, body, item, scene, free=False)
        if not is_rigid:
            add_tip(body, cell.tip, cup_point(scene))
        body.add_site(name="tip", pos=cup_point(scene))
        _add_sensors(spec, item.name)


def _add_sensors(spec: mujoco.MjSpec, held: str) -> None:
    sensor, site, body = mujoco.mjtSensor, mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_XBODY
    for name, kind, on, target in (
        (TIP_FORCE, sensor.mjSENS_FORCE, site, "tip"), (TIP_TORQUE, sensor.mjSENS_TORQUE, site, "tip"),
        (HELD_POSITION, sensor.mjSENS_FRAMEPOS, body, held),
        (HELD_X_AXIS, sensor.mjSENS_FRAMEXAXIS, body, held),
        (HELD_Z_AXIS, sensor.mjSENS_FRAMEZAXIS, body, held),
    ):  # fmt: skip
        spec.add_sensor(name=name, type=kind, objtype=on, objname=target)


def _add_object(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, item: SceneItem, scene: Scene, *, free: bool
) -> None:
    if free:
        body.add_freejoint(name=item.name)
    friction = scene.friction if item.friction is None else item.friction
    body.add_geom(
        name=item.name, **item.geometry(spec), mass=item.mass,
        friction=(friction, 0.005, item.rolling_friction), condim=item.contact_dimension,
        rgba=(*item.colour, 1.0),
    )  # fmt: skip
