"""KUKA KR 210 R2700-2 with a surface gripper, as an MjSpec subtree built from primitives.

Frames, masses, inertias and limits are those that the KUKA robot descriptions of kroshu publish
(`kuka_quantec_support`, Apache-2.0): every joint turns about its z axis in the manufacturer's sense, so
that a positive A1 turns clockwise seen from above. The shapes are our own.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.robots.joint_properties import Gears, JointLimits
from pack_core.rotations import Pose, from_rpy

BASE = "kr210_base"
"""Name of the body that does not move."""
JOINTS = tuple(f"joint_a{i}" for i in range(1, 7))
LIMITS = JointLimits(
    names=JOINTS,
    lower=np.deg2rad([-185.0, -140.0, -120.0, -350.0, -125.0, -350.0]),
    upper=np.deg2rad([185.0, -5.0, 168.0, 350.0, 125.0, 350.0]),
    velocity=np.array([2.038, 1.945, 1.955, 3.124, 3.002, 3.840]),
    acceleration=np.array([1.983, 1.263, 2.565, 7.039, 1.764, 1.873]),
    effort=np.array([7290.0, 8910.0, 6989.0, 2274.0, 1398.0, 782.0]),
)
JERK_LIMITS = LIMITS.acceleration / 0.1
"""Full acceleration within 0.1 s [rad/s^3]; not published."""
ARMATURE = np.array([300.0, 300.0, 200.0, 40.0, 40.0, 20.0])
"""Motor inertia seen through the gears [kg m^2]; not published, of the size of such drives."""
FRICTION = 0.015
"""Coulomb friction of a joint as a fraction of its effort; not published."""

ARM_BITS = 2 | 4
"""Bits of contype: 2 is the arm and its tool, 4 is the pad."""
ARM_CONTACT = {"contype": 2, "conaffinity": 0, "condim": 3}
"""The arm and its tool collide with geoms that have their bit in conaffinity, and never with each other."""
Capsules = tuple[tuple[float, tuple[float, ...]], ...]
"""Radius and both end points of each capsule [m]."""
Shapes = tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...]
"""Kind, place, size and colour of each: a `rod` is a cylinder from point to point with a radius, a
`round` a capsule likewise, a `block` a box at a point with half sizes."""

ORANGE = (0.95, 0.38, 0.05, 1.0)
DARK = (0.13, 0.13, 0.14, 1.0)
GREY = (0.42, 0.43, 0.45, 1.0)
STEEL = (0.62, 0.64, 0.66, 1.0)
"""Colours of the shapes, RGBA."""

BASE_SHAPES: Shapes = (
    ("block", (0, 0, 0.03), (0.40, 0.40, 0.03), DARK),
    ("rod", (0, 0, 0.06, 0, 0, 0.24), (0.34,), DARK),
    ("block", (-0.30, 0, 0.14), (0.14, 0.20, 0.10), DARK),
)
PEDESTAL_SHAPES: Shapes = (
    ("block", (0, 0, -0.5), (0.36, 0.36, 0.48), GREY),
    ("block", (0, 0, -0.01), (0.44, 0.44, 0.01), STEEL),
    ("block", (0, 0, -0.99), (0.44, 0.44, 0.01), STEEL),
)
"""For a pedestal of unit height with its top at z = 0; scaled to the height it has."""

LINK_SHAPES: tuple[Shapes, ...] = (
    (  # rotating column, in frame A1: z points down
        ("rod", (0, 0, -0.24, 0, 0, -0.38), (0.36,), ORANGE),
        ("round", (-0.05, 0, -0.42, 0.24, 0, -0.58), (0.21,), ORANGE),
        ("rod", (0.33, -0.10, -0.645, 0.33, 0.17, -0.645), (0.25,), ORANGE),
        ("rod", (0.33, 0.17, -0.645, 0.33, 0.40, -0.645), (0.12,), DARK),
        ("rod", (-0.22, 0.12, -0.40, -0.22, 0.12, -0.72), (0.10,), DARK),
    ),
    (  # upper arm, in frame A2: x along the arm, z to the side of the motor
        ("rod", (0, 0, -0.32, 0, 0, -0.10), (0.22,), ORANGE),
        ("block", (0.575, 0, -0.21), (0.52, 0.125, 0.085), ORANGE),
        ("block", (0.575, 0, -0.125), (0.36, 0.07, 0.01), DARK),
        ("rod", (1.15, 0, -0.30, 1.15, 0, -0.10), (0.18,), ORANGE),
    ),
    (  # elbow, in frame A3: y along the forearm
        ("rod", (0, 0, -0.10, 0, 0, 0.16), (0.175,), ORANGE),
        ("block", (0.10, -0.02, 0.03), (0.13, 0.21, 0.14), ORANGE),
        ("rod", (0.115, 0.15, 0, 0.115, 0.30, 0), (0.135,), DARK),
        ("rod", (0.19, -0.20, 0.08, 0.19, -0.44, 0.08), (0.065,), DARK),
        ("rod", (0.19, -0.20, -0.06, 0.19, -0.44, -0.06), (0.065,), DARK),
        ("rod", (0.04, -0.20, 0.02, 0.04, -0.42, 0.02), (0.060,), DARK),
    ),
    (  # forearm tube, in frame A4: -z along the forearm
        ("round", (0, 0, -0.34, 0, 0, -0.62), (0.125,), ORANGE),
        ("round", (0, 0, -0.60, 0, 0, -0.98), (0.100,), ORANGE),
        ("block", (0, 0.085, -1.13), (0.075, 0.025, 0.16), ORANGE),
        ("block", (0, -0.085, -1.13), (0.075, 0.025, 0.16), ORANGE),
        ("rod", (0, 0, -0.30, 0, 0, -0.34), (0.145,), STEEL),
    ),
    (  # wrist, in frame A5
        ("rod", (0, 0, -0.115, 0, 0, 0.115), (0.085,), DARK),
        ("round", (0, -0.01, 0, 0, -0.08, 0), (0.075,), DARK),
    ),
    (  # mounting flange, in frame A6: -z out of the arm
        ("rod", (0, 0, -0.08, 0, 0, -0.185), (0.085,), DARK),
        ("rod", (0, 0, -0.185, 0, 0, -0.215), (0.100,), STEEL),
    ),
)  # fmt: skip
LINK_CAPSULES: tuple[Capsules, ...] = (
    ((0.30, (-0.05, 0, -0.25, 0.20, 0, -0.58)),),
    ((0.18, (0.05, 0, -0.20, 1.15, 0, -0.20)),),
    ((0.20, (0.08, -0.22, 0.02, 0.08, 0.10, 0.02)),),
    ((0.13, (0, 0, -0.20, 0, 0, -0.62)), (0.11, (0, 0, -0.62, 0, 0, -1.16))),
    ((0.11, (0, 0, -0.03, 0, 0, 0.03)),),
    ((0.09, (0, 0, -0.09, 0, 0, -0.12)),),
)
"""What collides, of each link, in the frame of its joint: drawn around the shapes."""


@dataclass(frozen=True)
class Kr210Link:
    """One link: the frame of its joint on the link before it, and its mass and inertia, as published."""

    X_PJ: Pose
    """Joint frame in the parent's, at q = 0; the joint turns about z."""
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float]
    """Principal moments about the centre of mass [kg m^2]."""
    inertia_rpy: tuple[float, float, float]
    """Roll, pitch and yaw of the principal axes in the joint frame [rad]."""


def _link(
    xyz: tuple[float, ...], rpy: tuple[float, ...], mass: float, com: tuple[float, float, float],
    inertia: tuple[float, float, float], inertia_rpy: tuple[float, float, float],
) -> Kr210Link:  # fmt: skip
    return Kr210Link(Pose(np.array(xyz), from_rpy(rpy)), mass, com, inertia, inertia_rpy)


HALF, FULL = np.pi / 2, np.pi
"""A quarter turn and half a turn [rad]."""
LINKS = (
    _link((0, 0, 0), (-FULL, 0, 0), 363.07, (0.0288, 0.0119, -0.2340),
          (13.21, 31.49, 33.88), (1.866, 0.103, -0.216)),
    _link((0.33, 0, -0.645), (HALF, 0, 0), 232.06, (0.4869, -0.0019, -0.1176),
          (57.80, 5.633, 58.56), (-2.820, -1.218, 1.278)),
    _link((1.15, 0, 0), (0, 0, -HALF), 190.33, (0.1738, -0.0760, 0.1362),
          (3.470, 21.17, 22.21), (2.182, -0.066, -0.053)),
    _link((0.115, 0, 0), (HALF, 0, 0), 42.41, (0.0, 0.0192, -0.1979),
          (0.161, 1.365, 1.392), (1.571, -1.437, -1.571)),
    _link((0, 0, -1.22), (-HALF, 0, 0), 16.99, (0.0622, 0.0003, -0.0658),
          (0.200, 0.121, 0.221), (1.570, -0.876, -0.002)),
    _link((0, 0, 0), (HALF, 0, 0), 6.60, (0.0, 0.0, -0.0065),
          (0.0115, 0.0115, 0.0145), (0.0, 0.0, 0.0)),
)  # fmt: skip
WRIST_LENGTH = 0.215
"""From the centre of the wrist to the flange [m]."""
X_6F = Pose(np.array([0.0, 0.0, -WRIST_LENGTH]), from_rpy((0.0, FULL, 0.0)))
"""Flange F in the last link's frame; its z axis points out of the flange."""


def add_kr210(
    spec: mujoco.MjSpec, X_WB: Pose, *, visuals: bool, gears: Gears | None = None
) -> mujoco.MjsBody:
    """Add the arm without a tool.

    Args:
        spec: the model under construction.
        X_WB: pose of its base.
        visuals: whether shapes for pictures are added to the colliding ones.
        gears: elastic gears; the deflection of each is a joint of its own, see `gear_joint`.

    Returns:
        The body `flange`, whose z axis points out of the arm.
    """
    parent = spec.worldbody.add_body(name=BASE, pos=X_WB.p, quat=X_WB.q)
    if visuals:
        draw_base(parent, X_WB.p[2])
    for i, link in enumerate(LINKS):
        parent = parent.add_body(name=f"kr210_link{i + 1}", pos=link.X_PJ.p, quat=link.X_PJ.q)
        parent.mass, parent.ipos, parent.iquat = link.mass, link.com, from_rpy(link.inertia_rpy)
        parent.inertia, parent.explicitinertial = link.inertia, True
        parent.add_joint(
            name=JOINTS[i], type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1), limited=True,
            range=(LIMITS.lower[i], LIMITS.upper[i]), armature=ARMATURE[i],
            frictionloss=FRICTION * LIMITS.effort[i],
        )  # fmt: skip
        if gears is not None:
            parent.add_joint(
                name=gear_joint(JOINTS[i]), type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1),
                armature=gears.inertia[i], damping=gears.damping[i],
            )  # fmt: skip
        for radius, ends in LINK_CAPSULES[i]:
            parent.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=ends, size=(radius, 0, 0), mass=0,
                rgba=(0, 0, 0, 0), group=3, **ARM_CONTACT,
            )  # fmt: skip
        if visuals:
            draw_link(parent, i)
    return parent.add_body(name="flange", pos=X_6F.p, quat=X_6F.q)


def gear_joint(joint: str) -> str:
    """Name of the hinge whose angle is the deflection of a joint's gear."""
    return f"{joint}_gear"


def draw_base(body: mujoco.MjsBody, height: float) -> None:
    """Draw the base, and a pedestal of the given height [m] under it."""
    _draw(body, BASE_SHAPES)
    if height <= 0.0:
        return
    for kind, (x, y, z), (a, b, c), colour in PEDESTAL_SHAPES:
        _draw(body, ((kind, (x, y, z * height), (a, b, c * height), colour),))


def draw_link(body: mujoco.MjsBody, index: int) -> None:
    """Draw link `index`, counted from 0."""
    _draw(body, LINK_SHAPES[index])


def _draw(body: mujoco.MjsBody, shapes: Shapes) -> None:
    kinds = {"rod": mujoco.mjtGeom.mjGEOM_CYLINDER, "round": mujoco.mjtGeom.mjGEOM_CAPSULE}
    for kind, place, size, colour in shapes:
        where = {"pos": place} if kind == "block" else {"fromto": place}
        body.add_geom(
            type=kinds.get(kind, mujoco.mjtGeom.mjGEOM_BOX), size=(*size, 0, 0)[:3], rgba=colour, mass=0,
            contype=0, conaffinity=0, **where,
        )  # fmt: skip
