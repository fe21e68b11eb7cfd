"""A robot without its surroundings: model, links, joints, and its description as URDF."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np

from pack_core.errors import ConfigError
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array, Pose, to_matrix

WORLD = "world"
UPRIGHT = 1e-7
"""Horizontal part of a unit vector below which it points up or down."""
HIDDEN_GROUP = 3
"""Geoms of this group and above are for collisions alone, and are not drawn."""
KINDS = {mujoco.mjtJoint.mjJNT_HINGE: "revolute", mujoco.mjtJoint.mjJNT_SLIDE: "prismatic"}
"""Joints of URDF by those of MuJoCo; a body without a joint is fixed to its parent."""
Shape = tuple[str, dict[str, str], Pose]
"""Element of URDF, its attributes, and X_BG: its pose in the link's frame."""


@dataclass(frozen=True)
class DescribedRobot:
    """A robot as it is told to viewers.

    Attributes:
        model: the robot alone, with the shapes that pictures show.
        links: names of its links, the base first; they are frames in /tf.
        joints: names of its joints, fingers included.
        urdf: the same as URDF.
    """

    model: mujoco.MjModel
    links: tuple[str, ...]
    joints: tuple[str, ...]
    urdf: str

    @classmethod
    def of(cls, spec: mujoco.MjSpec, name: str, limits: JointLimits) -> DescribedRobot:
        """The robot of a specification that holds nothing else.

        Args:
            spec: its first body is fixed to the world.
            name: of the robot.
            limits: of the arm's joints.

        Raises:
            ConfigError: URDF cannot express a body's joints.
        """
        model = spec.compile()
        root = model.body(1).name  # body 0 is the world
        links = tuple(model.body(body).name for body in bodies_below(model, root))
        joints = tuple(model.joint(joint).name for joint in range(model.njnt))
        return cls(model, links, joints, robot_description(model, root, name, limits))


def robot_description(model: mujoco.MjModel, root: str, name: str, limits: JointLimits) -> str:
    """The URDF of the bodies below `root`; links and joints carry the model's names.

    The link `world` is the parent of `root`. Every other link's frame is that of its body, which in these
    models lies in the joint's axis, as URDF wants it. Shapes for collisions are those that touch something
    in the simulation; a link without such shapes has those that are drawn. Masses and moments of inertia are
    the model's.

    Args:
        model: with joint positions 0 where URDF has them, so without reference angles.
        root: name of the robot's first body, which is fixed to the world.
        name: of the robot.
        limits: of the arm's joints; the others, of fingers, get neither effort nor speed.

    Raises:
        ConfigError: a body has two joints, or one beside its frame's origin or of another kind.
    """
    robot = Element("robot", name=name)
    SubElement(robot, "link", name=WORLD)
    for body in bodies_below(model, root):
        _add_link(robot, model, body)
        _add_joint(robot, model, body, limits)
    ElementTree.indent(robot)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(robot, encoding="unicode") + "\n"


def bodies_below(model: mujoco.MjModel, root: str) -> list[int]:
    """Ids of a body and of all below it, parents before children."""
    found = {model.body(root).id}
    for body in range(min(found) + 1, model.nbody):
        if int(model.body_parentid[body]) in found:
            found.add(body)
    return sorted(found)


def _add_link(robot: Element, model: mujoco.MjModel, body: int) -> None:
    link = SubElement(robot, "link", name=model.body(body).name)
    _add_inertia(link, model, body)
    start = int(model.body_geomadr[body])
    geoms = range(start, start + int(model.body_geomnum[body]))
    drawn = [g for g in geoms if model.geom_group[g] < HIDDEN_GROUP and model.geom_rgba[g, 3] > 0.0]
    touching = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]
    for geom in drawn:
        for visual in _add_shapes(link, "visual", model, geom):
            material = SubElement(visual, "material", name=f"colour of geom {geom}")
            SubElement(material, "color", rgba=_text(model.geom_rgba[geom]))
    for geom in touching or drawn:
        _add_shapes(link, "collision", model, geom)


def _add_shapes(link: Element, kind: str, model: mujoco.MjModel, geom: int) -> list[Element]:
    """The elements of a geom, of which a capsule has three."""
    added = []
    for shape, sizes, X_BG in _shapes(model, geom):
        element = SubElement(link, kind)
        _add_origin(element, X_BG)
        SubElement(SubElement(element, "geometry"), shape, sizes)
        added.append(element)
    return added


def _add_inertia(link: Element, model: mujoco.MjModel, body: int) -> None:
    """Mass and moments about the centre of mass, in the axes of inertia; none for a frame without mass."""
    if model.body_mass[body] == 0.0:
        return
    inertial = SubElement(link, "inertial")
    _add_origin(inertial, Pose(model.body_ipos[body], model.body_iquat[body]))
    SubElement(inertial, "mass", value=f"{model.body_mass[body]:.9g}")
    moments = {
        f"i{axis}{axis}": f"{moment:.9g}"
        for axis, moment in zip("xyz", model.body_inertia[body], strict=True)
    }
    SubElement(inertial, "inertia", moments | {"ixy": "0", "ixz": "0", "iyz": "0"})


def _add_joint(robot: Element, model: mujoco.MjModel, body: int, limits: JointLimits) -> None:
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    name = model.body(body).name
    parent = model.body(model.body_parentid[body]).name  # MuJoCo's own name of the world is `world`
    if count > 1:
        raise ConfigError(f"body '{name}' has {count} joints; URDF allows 1: give a model with rigid gears")
    joint = SubElement(robot, "joint", name=f"{name}_mount" if count == 0 else model.joint(first).name)
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=name)
    _add_origin(joint, Pose(model.body_pos[body], model.body_quat[body]))
    if count == 0:
        joint.set("type", "fixed")
        return
    kind = mujoco.mjtJoint(model.jnt_type[first])
    if kind not in KINDS or np.any(model.jnt_pos[first]) or model.qpos0[model.jnt_qposadr[first]] != 0.0:
        raise ConfigError(f"joint of body '{name}' is no hinge or slide at its frame's origin with angle 0")
    joint.set("type", KINDS[kind])
    SubElement(joint, "axis", xyz=_text(model.jnt_axis[first]))
    lower, upper = model.jnt_range[first]
    effort = velocity = 0.0  # URDF demands both
    if (known := joint.get("name")) in limits.names:
        index = limits.names.index(known)
        effort, velocity = limits.effort[index], limits.velocity[index]
    values = {"lower": lower, "upper": upper, "effort": effort, "velocity": velocity}
    SubElement(joint, "limit", {what: f"{value:.9g}" for what, value in values.items()})
    _add_mimic(joint, model, first)


def _add_mimic(element: Element, model: mujoco.MjModel, joint: int) -> None:
    """Say of which joint this one is a linear function, as of fingers that move together."""
    for equality in range(model.neq):
        if model.eq_type[equality] == mujoco.mjtEq.mjEQ_JOINT and model.eq_obj1id[equality] == joint:
            leader = model.joint(model.eq_obj2id[equality]).name
            offset, multiplier = model.eq_data[equality, :2]
            SubElement(element, "mimic", joint=leader, multiplier=f"{multiplier:.9g}", offset=f"{offset:.9g}")


def _shapes(model: mujoco.MjModel, geom: int) -> Iterator[Shape]:
    """A geom as shapes of URDF, which has no capsule and takes a mesh only from a file."""
    X_BG = Pose(model.geom_pos[geom], model.geom_quat[geom])
    kind, size = mujoco.mjtGeom(model.geom_type[geom]), model.geom_size[geom]
    if kind in SHAPES:
        yield from SHAPES[kind](size, X_BG)
    elif kind == mujoco.mjtGeom.mjGEOM_MESH:  # its bounding box: centre and half edges in the geom's frame
        centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        yield from _box(half, X_BG @ Pose(centre))


def _box(half: Array, X_BG: Pose) -> Iterator[Shape]:
    yield "box", {"size": _text(2.0 * half)}, X_BG


def _cylinder(size: Array, X_BG: Pose) -> Iterator[Shape]:
    yield "cylinder", {"radius": f"{size[0]:.9g}", "length": f"{2.0 * size[1]:.9g}"}, X_BG


def _sphere(size: Array, X_BG: Pose) -> Iterator[Shape]:
    yield "sphere", {"radius": f"{size[0]:.9g}"}, X_BG


def _capsule(size: Array, X_BG: Pose) -> Iterator[Shape]:
    """A cylinder with a ball at each end; MuJoCo's half length does not count the balls."""
    yield from _cylinder(size, X_BG)
    for end in (-size[1], size[1]):
        yield from _sphere(size, X_BG @ Pose(np.array([0.0, 0.0, end])))


SHAPES: dict[mujoco.mjtGeom, Callable[[Array, Pose], Iterator[Shape]]] = {
    mujoco.mjtGeom.mjGEOM_BOX: _box,
    mujoco.mjtGeom.mjGEOM_CYLINDER: _cylinder,
    mujoco.mjtGeom.mjGEOM_SPHERE: _sphere,
    mujoco.mjtGeom.mjGEOM_CAPSULE: _capsule,
}


def _add_origin(parent: Element, X: Pose) -> None:
    SubElement(parent, "origin", xyz=_text(X.p), rpy=_text(_roll_pitch_yaw(X)))


def _roll_pitch_yaw(X: Pose) -> Array:
    """Angles `(3,)` [rad] about the fixed axes x, y and z, one after the other, as URDF has them."""
    R = to_matrix(X.q)
    level = np.hypot(R[0, 0], R[1, 0])
    pitch = np.arctan2(-R[2, 0], level)
    # With a pitch of 90 degrees, as between many links, roll and yaw turn about one axis: yaw is zero then.
    if level < UPRIGHT:
        return np.array([np.arctan2(-R[1, 2], R[1, 1]), pitch, 0.0])
    return np.array([np.arctan2(R[2, 1], R[2, 2]), pitch, np.arctan2(R[1, 0], R[0, 0])])


def _text(values: Array) -> str:
    # 9 digits, and no minus zero, so that the text does not depend on rounding
    return " ".join(f"{value + 0.0:.9g}" for value in np.where(np.abs(values) < 1e-12, 0.0, values))
