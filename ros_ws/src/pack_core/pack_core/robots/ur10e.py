"""Universal Robots UR10e: kinematics, limits, and an MjSpec subtree built from primitives.

Denavit-Hartenberg parameters, masses, centres of mass and inertias: Universal Robots, "DH parameters
for calculations of kinematics and dynamics". Speeds and torques: the manual and "Max. joint torques".
Accelerations are not published: those here are moderate. Nor are rotor inertias: `ARMATURE` is what
motors of this size have behind a reduction of 100.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array, Pose, exp, to_matrix

JOINTS = (
    "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
    "wrist_1_joint", "wrist_2_joint", "wrist_3_joint",
)  # fmt: skip
BASE = "ur10e_base"
"""Name of the body of the base, which does not move."""
_TURN = 2 * np.pi
"""A whole turn [rad]."""
LIMITS = JointLimits(
    names=JOINTS,
    lower=np.array([-_TURN, -_TURN, -np.pi, -_TURN, -_TURN, -_TURN]),
    upper=np.array([_TURN, _TURN, np.pi, _TURN, _TURN, _TURN]),
    velocity=np.deg2rad([120.0, 120.0, 180.0, 180.0, 180.0, 180.0]),
    acceleration=np.array([6.0, 6.0, 8.0, 12.0, 12.0, 12.0]),
    effort=np.array([330.0, 330.0, 150.0, 56.0, 56.0, 56.0]),
)
ARMATURE = np.array([1.2, 1.2, 0.6, 0.15, 0.15, 0.15])
"""Motor inertia seen through the gears [kg m^2]."""

D1, D4, D5, D6 = 0.1807, 0.17415, 0.11985, 0.11655
"""Offsets along the joint axes of the DH table [m]."""
A2, A3 = -0.6127, -0.57155
"""Lengths of upper arm and forearm of the DH table [m]."""

_DH = (  # a, d, alpha; mass, centre of mass and inertia (xx, yy, zz, xy, xz, yz) in the DH frame after it
    (0.0, D1, np.pi / 2, 7.369, (0.021, 0.0, 0.027), (0.0341, 0.0353, 0.0216, 0.0, -0.0043, 0.0001)),
    (A2, 0.0, 0.0, 13.051, (0.38, 0.0, 0.158), (0.0281, 0.7707, 0.7694, 0.0001, -0.0156, 0.0)),
    (A3, 0.0, 0.0, 3.989, (0.24, 0.0, 0.068), (0.0101, 0.3093, 0.3065, 0.0001, 0.0092, 0.0)),
    (0.0, D4, np.pi / 2, 2.1, (0.0, 0.007, 0.018), (0.0030, 0.0022, 0.0026, 0.0, 0.0, -0.0002)),
    (0.0, D5, -np.pi / 2, 1.98, (0.0, 0.007, 0.018), (0.0030, 0.0022, 0.0026, 0.0, 0.0, -0.0002)),
    (0.0, D6, 0.0, 0.615, (0.0, 0.0, -0.026), (0.0003, 0.0003, 0.0002, 0.0, 0.0, 0.0)),
)

WHITE, STEEL, BLUE = (0.88, 0.89, 0.91, 1.0), (0.45, 0.47, 0.50, 1.0), (0.36, 0.62, 0.80, 1.0)
"""Colours of tubes, flanges and joints' caps, RGBA."""
Stroke = tuple[float, tuple[float, ...], tuple[float, ...]]
_HOUSINGS: tuple[tuple[Stroke, ...], ...] = (  # radius, both ends in the joint's frame [m], colour
    ((0.075, (0, 0, 0.10, 0, 0, 0.24), WHITE), (0.073, (0, -0.02, 0.181, 0, -0.09, 0.181), STEEL)),
    ((0.073, (0, 0, 0.09, 0, 0, 0.24), BLUE), (0.055, (0, 0, 0.176, A2, 0, 0.176), WHITE),
     (0.062, (A2, 0, 0.09, A2, 0, 0.24), BLUE)),
    ((0.060, (0, 0, -0.02, 0, 0, 0.09), STEEL), (0.046, (0, 0, 0.040, A3, 0, 0.040), WHITE),
     (0.050, (A3, 0, -0.02, A3, 0, 0.09), BLUE)),
    ((0.046, (0, 0, 0.095, 0, 0, 0.215), WHITE), (0.045, (0, 0, D4, 0, -0.06, D4), BLUE)),
    ((0.046, (0, 0, 0.062, 0, 0, 0.160), WHITE), (0.045, (0, 0, D5, 0, 0.06, D5), BLUE)),
    ((0.045, (0, 0, D6 - 0.045, 0, 0, D6), STEEL),),
)  # fmt: skip


@dataclass(frozen=True)
class Ur10eLink:
    """One link; its joint turns about z of its frame J."""

    X_PJ: Pose
    """J in the parent's joint frame, at angle 0."""
    mass: float
    com: Array
    """Centre of mass in J."""
    inertia: Array
    """About the centre of mass, in axes of J `(3, 3)` [kg m^2]."""


def _links() -> tuple[Ur10eLink, ...]:
    X_PJ, links = Pose(np.zeros(3)), []
    for a, d, alpha, mass, com, (xx, yy, zz, xy, xz, yz) in _DH:
        # The tables give mass and inertia in the DH frame D after the link; J is the frame of its own joint.
        X_JD = Pose(np.array([a, 0.0, d]), exp([alpha, 0.0, 0.0]))
        R_JD, moments = to_matrix(X_JD.q), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        links.append(Ur10eLink(X_PJ, mass, X_JD.apply(com), R_JD @ moments @ R_JD.T))
        X_PJ = X_JD
    return tuple(links)


LINKS = _links()
X_6F = Pose(np.array([0.0, 0.0, D6]))
"""Pose of the flange, z pointing out of it, in the frame of the last joint."""


def add_ur10e(spec: mujoco.MjSpec, X_WB: Pose, *, contype: int, conaffinity: int) -> mujoco.MjsBody:
    """Add the arm on its base frame B.

    Args:
        spec: the model under construction.
        X_WB: pose of the base, whose z axis is the first joint's; at angles 0 the arm lies along minus x.
        contype: contype of the housings.
        conaffinity: conaffinity of the housings.

    Returns:
        The body `flange`, to hang a tool on.
    """
    body = spec.worldbody.add_body(name=BASE, pos=X_WB.p, quat=X_WB.q)
    _draw(body, ((0.095, (0, 0, 0, 0, 0, 0.10), STEEL),), 0, 0)
    for i, link in enumerate(LINKS):
        body = body.add_body(name=f"ur10e_link{i + 1}", pos=link.X_PJ.p, quat=link.X_PJ.q)
        I = link.inertia
        body.mass, body.ipos, body.explicitinertial = link.mass, link.com, True
        body.fullinertia = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])
        body.add_joint(
            name=JOINTS[i], type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1), limited=True,
            range=(LIMITS.lower[i], LIMITS.upper[i]), armature=ARMATURE[i],
        )  # fmt: skip
        _draw(body, _HOUSINGS[i], contype, conaffinity)
    return body.add_body(name="flange", pos=X_6F.p, quat=X_6F.q)


def add_motors(spec: mujoco.MjSpec) -> None:
    """A torque actuator on every joint, within the limits; controls are torques `(6,)` [N m]."""
    for name, limit in zip(JOINTS, LIMITS.effort, strict=True):
        spec.add_actuator(
            name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, ctrllimited=True,
            ctrlrange=(-limit, limit),
        ).set_to_motor()  # fmt: skip


def _draw(body: mujoco.MjsBody, strokes: tuple[Stroke, ...], contype: int, conaffinity: int) -> None:
    for radius, ends, rgba in strokes:
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER if rgba != WHITE else mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=ends, size=(radius, 0, 0), rgba=rgba, mass=0, contype=contype, conaffinity=conaffinity,
        )  # fmt: skip
