"""MuJoCo models of the packing cell: one builder, with roles for the arm and for the new object.

Beside it stand what a model is made of (table, container, the cup's springs, surroundings for pictures) and
what viewers are told of the cell: its fixed frames, and its arm as URDF.
"""

from __future__ import annotations

from enum import Enum

import mujoco
import numpy as np

from pack_core.camera import looking_at
from pack_core.drawing.room import Light, add_lights, add_sky, add_table, add_tiles
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell, Perception, Tip
from pack_core.packing.scene import Container, Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.robots.arm_drive import add_motors, add_servos, make_heavy
from pack_core.robots.pump import add_pump
from pack_core.robots.urdf import DescribedRobot
from pack_core.rotations import POINTING_DOWN, Array, Pose, conjugate, multiply, rotate

TIP_FORCE = "tip_force"
TIP_TORQUE = "tip_torque"
HELD_POSITION = "held_position"
HELD_X_AXIS = "held_x_axis"
HELD_Z_AXIS = "held_z_axis"
WALLS = ("wall_left", "wall_right", "wall_near", "wall_far")
STEERING_STIFFNESS = np.array([1000.0, 1000.0, 1000.0, 30.0, 30.0, 30.0])
"""[N/m] and [N m/rad]: what the driver's joint servos give the held object, within a factor of two."""
STEERING_DAMPING = np.array([80.0, 80.0, 80.0, 1.5, 1.5, 1.5])
"""Damping along and about the world's axes [N s/m] and [N m s/rad]."""
WORLD_SITE = "world_frame"
SLIDES = ("tip_x", "tip_y", "tip_z")
HINGES = ("tip_roll", "tip_pitch", "tip_yaw")
TIP_JOINTS = (*SLIDES, *HINGES)
"""The joints in their order, in the held object's axes: it shifts first, then turns about x, y and z."""
PARKED = np.array([-5.0, 0.0])
"""Where the first of them stands, out of reach of everything else: x and y [m]."""
PARKING_GAP = 1.0
"""Distance from one to the next [m]."""


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
    """On the springs of the cup, its weight not compensated."""
    FREE = "free"
    """A free body that nothing holds."""
    STEERED = "steered"
    """A body of its own without weight, pulled by springs to a pose that the caller commands: those
    of the joints' servos and, behind them, of the cup where it has any."""
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
    _add_table(spec, scene.friction, surroundings)
    _add_container(spec, scene.container, scene.friction)
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
        _add_surroundings(spec, scene.container)
    return spec.compile()


def held_pose(scene: Scene) -> Pose:
    """X_TN of the held new object N on the cup T; unless told, it hangs upright by the middle of its top."""
    if scene.grip is not None:
        return scene.grip.to_pose()
    return Pose(np.array([0.0, 0.0, scene.new_object.half_extents[2]]), POINTING_DOWN)


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
            _add_steering(spec, body, cell)
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


def _add_table(spec: mujoco.MjSpec, friction: float, surroundings: bool) -> None:
    """Add the plane of the table, which is not drawn where `surroundings` draw a floor instead."""
    spec.worldbody.add_geom(
        name="table", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(1.0, 0.8, 0.1), condim=3,
        friction=(friction, 0.005, 0.0001),
        rgba=(0.5, 0.5, 0.5, 0.0 if surroundings else 1.0),
    )  # fmt: skip


def _add_container(spec: mujoco.MjSpec, container: Container, friction: float) -> None:
    """Add the four walls, whose inner faces are as far apart as the container's size says."""
    # half extents, as MuJoCo's boxes take them
    (w, l), h, t = 0.5 * np.array(container.size), 0.5 * container.height, 0.5 * container.wall
    x, y = container.centre
    sides = {
        "wall_left": ((x, y + l + t), (w + 2 * t, t)), "wall_right": ((x, y - l - t), (w + 2 * t, t)),
        "wall_near": ((x - w - t, y), (t, l)), "wall_far": ((x + w + t, y), (t, l)),
    }  # fmt: skip
    for name, ((px, py), (sx, sy)) in sides.items():
        spec.worldbody.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, pos=(px, py, h), size=(sx, sy, h),
            friction=(friction, 0.005, 0.0001), condim=3, rgba=(0.25, 0.42, 0.62, 1.0),
        )  # fmt: skip


def _add_steering(spec: mujoco.MjSpec, body: mujoco.MjsBody, cell: PackingCell) -> None:
    """Add six actuators whose controls are the body's desired position [m] and rotation vector [rad].

    Along each axis they pull with up to the cell's push force, and turn about it with up to its moment.
    """
    limits = np.repeat([cell.push.force, cell.push.moment], 3)
    stiffness = STEERING_STIFFNESS
    if cell.tip is not None:  # springs one behind the other: 1 / k = 1 / k1 + 1 / k2
        stiffness = 1.0 / (1.0 / stiffness + 1.0 / np.array(cell.tip.stiffness))
    spec.worldbody.add_site(name=WORLD_SITE)
    body.add_site(name=body.name)
    # gear k selects direction k of the site's transform: three translations, then three rotations
    for i, gear in enumerate(np.eye(6)):
        actuator = spec.add_actuator(
            name=f"steering_{i}", target=body.name, refsite=WORLD_SITE, trntype=mujoco.mjtTrn.mjTRN_SITE,
            gear=gear, forcelimited=True, forcerange=(-limits[i], limits[i]),
        )  # fmt: skip
        actuator.set_to_position(kp=stiffness[i], kv=STEERING_DAMPING[i])


def add_tip(body: mujoco.MjsBody, tip: Tip | None, p_NP: Array) -> None:
    """Hang a held object on the springs of the cup.

    Args:
        body: the held object.
        tip: stiffness and damping of the springs.
        p_NP: the cup's point P `(3,)` in the body's frame [m].

    Raises:
        ConfigError: the cup has no springs.
    """
    if tip is None:
        raise ConfigError("a compliant grip needs stiffnesses; give `tip` in config/cells/packing.yaml")
    kinds = [mujoco.mjtJoint.mjJNT_SLIDE] * 3 + [mujoco.mjtJoint.mjJNT_HINGE] * 3
    for i, name in enumerate(TIP_JOINTS):
        body.add_joint(
            name=name, type=kinds[i], axis=np.eye(3)[i % 3], pos=p_NP, stiffness=tip.stiffness[i],
            damping=tip.damping_time * tip.stiffness[i],
        )  # fmt: skip


def tip_coordinates(X_TN0: Pose, X_TN: Pose, p_NP: Array) -> Array:
    """Coordinates `(6,)` [m, rad] of the tip's joints that bring the held object from X_TN0 to X_TN.

    The joints are at the cup's point P, `p_NP` `(3,)` [m] in the object's frame.
    """
    from scipy.spatial.transform import Rotation  # 0.3 s and 20 MB, which a cell with a stiff cup saves

    inverse = conjugate(X_TN0.q)
    shift = rotate(inverse, X_TN.apply(p_NP) - X_TN0.apply(p_NP))
    # intrinsic angles "XYZ", since the hinges turn about x, y and z one after the other
    turn = Rotation.from_quat(multiply(inverse, X_TN.q), scalar_first=True).as_euler("XYZ")
    return np.concatenate([shift, turn])


def _add_surroundings(spec: mujoco.MjSpec, container: Container) -> None:
    """Add a table, a floor, a sky and lights that cast soft shadows."""
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = 1920, 1080
    visual.quality.shadowsize = 4096
    visual.headlight.ambient = (0.34, 0.34, 0.34)
    visual.headlight.diffuse, visual.headlight.specular = (0.25, 0.25, 0.25), (0.0, 0.0, 0.0)
    visual.map.shadowclip = 1.4
    add_sky(spec, (0.95, 0.96, 0.98), (0.70, 0.76, 0.82))
    add_tiles(spec, "tiles", (0.70, 0.71, 0.73), (0.62, 0.63, 0.65), reflectance=0.03)
    spec.add_material(name="table", rgba=(0.80, 0.76, 0.70, 1.0), specular=0.1, shininess=0.2)
    add_table(spec, (0.35, 0.0), (1.5, 1.2), top="table", floor="tiles")
    x, y = container.centre
    lights = (
        Light((x + 0.6, y - 0.8, 2.5), (-0.35, 0.4, -1.0), 0.42, True),
        Light((x - 1.0, y + 1.2, 2.0), (0.5, -0.6, -1.0), 0.16, False),
    )
    add_lights(spec, lights, specular=0.15)


def parked_pose(i: int, item: SceneItem) -> Pose:
    """X_WO of object number `i` of a scene while it is parked: it stands on the table's plane."""
    x, y = PARKED - (PARKING_GAP * i, 0.0)
    return Pose(np.array([x, y, item.half_extents[2]]))


def describe_robot(cell: PackingCell) -> DescribedRobot:
    """The arm and the pump; the cup is the link `tool`."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    arm = cell.robot.arm
    add_pump(arm.add_to(spec), cell.pump, arm.flange)
    return DescribedRobot.of(spec, arm.name, arm.limits)


def fixed_frames(cell: PackingCell, container: Container) -> dict[str, tuple[str, Pose]]:
    """X_PF and the parent's name P, by the name of frame F.

    Besides container and table there are two at the tool. `cup` is the cup's lip. `tip` is the frame of
    `/wrench`: the middle of the held object's top, with the axes of an object that hangs upright (what a
    compliant cup adds to that is left out). `mocap_camera_1` and so on, or `depth_1` and so on, look
    along z, with x to the right.
    """
    here = Pose(np.zeros(3))
    frames = {
        "table": ("world", here),
        "container": ("world", Pose(np.array([*container.centre, 0.0]))),
        "cup": ("tool", here),
        "tip": ("tool", Pose(np.zeros(3), POINTING_DOWN)),
    }
    if cell.perception is Perception.DEPTH:
        for name, camera in zip(cell.depth.names, cell.depth.cameras(), strict=True):
            frames[name] = ("world", camera.X_WC)
        return frames
    for number, position in enumerate(cell.mocap.cameras, start=1):
        frames[f"mocap_camera_{number}"] = ("world", looking_at(position, cell.mocap.target))
    return frames
