"""A seven-axis arm as data, and its MuJoCo bodies, built from capsules and cylinders.

Every arm of the packing cell is one `SevenAxisArm` in a file of its own beside this one, listed in
`pack_core.robots.packing_arms`. No other code knows an arm by its name.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Pose

Colour = tuple[float, float, float, float]
Capsule = tuple[float, tuple[float, ...]]
"""Radius and both end points in the link's frame, x, y, z each [m]."""

AXES = 7
"""Number of the arm's joints, and of its links without the base."""
ELBOW = 3
"""Index of joint 4, the elbow."""
UNROTATED = (1.0, 0.0, 0.0, 0.0)
"""No turn, as a quaternion wxyz."""
_S = 0.7071067811865476
"""Sine and cosine of half a right angle."""
QUARTER_X = (_S, _S, 0.0, 0.0)
"""A quarter turn about x, as a quaternion wxyz."""
MINUS_QUARTER_X = (_S, -_S, 0.0, 0.0)
"""A quarter turn back about x, as a quaternion wxyz."""
RING_HALF_LENGTH = 0.03
"""Every joint is drawn as a ring of twice this length about its axis [m]."""


@dataclass(frozen=True)
class ArmLink:
    """One moving link; its frame has the joint's axis as z.

    Attributes:
        pos: of the frame in the frame of the link before it [m].
        quat: orientation of the frame in the frame of the link before it, wxyz.
        mass: [kg].
        com: centre of mass [m].
        inertia: about the centre of mass, along the frame's axes: xx, yy, zz, xy, xz, yz [kg m^2].
        capsules: the link as it is drawn, and as it stands in the cameras' way.
        ring_radius: of the ring that shows the joint [m].
        is_accented: whether the ring has the arm's accent colour.
    """

    pos: tuple[float, float, float]
    quat: tuple[float, float, float, float]
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]
    capsules: tuple[Capsule, ...]
    ring_radius: float
    is_accented: bool = False


@dataclass(frozen=True)
class SevenAxisArm:
    """An arm that can pack: kinematics, inertias, limits, and how it is drawn.

    Attributes:
        name: as the cell's `robot.model` gives it; its bodies are `<name>_link0` to `<name>_link7`.
        limits: names and published limits of the joints.
        links: seven of them, the first one on the base.
        base: the base as it is drawn; its frame is the world's.
        flange: distance from the last joint's frame to the flange, along its axis [m].
        payload: what the flange may carry [kg].
        reach: nearest x and farthest horizontal distance from the base at which the tool works while it
            points down to the table [m].
        joint_damping: viscous friction of each joint [N m s/rad].
        armature: rotor inertia of each joint, seen through its gear [kg m^2].
        shell: colour of the links.
        dark: colour of the base and of the joints.
        accent: colour of the accented joints.
    """

    name: str
    limits: JointLimits
    links: tuple[ArmLink, ...]
    base: tuple[Capsule, ...]
    flange: float
    payload: float
    reach: tuple[float, float]
    joint_damping: float
    armature: float
    shell: Colour
    dark: Colour
    accent: Colour

    def __post_init__(self) -> None:
        if not len(self.links) == len(self.limits) == AXES:
            raise ValueError(
                f"arm '{self.name}' has {len(self.links)} links and limits of {len(self.limits)} joints; "
                "allowed: seven of each"
            )

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints from the base on, as they appear in models and messages."""
        return self.limits.names

    @property
    def straight(self) -> float:
        """Position of joint 4 [rad] at which the wrist is farthest from the shoulder: the singular elbow.

        Joints 1 to 3 meet in the shoulder, the origin of link 2, and joints 5 to 7 turn the wrist, the origin
        of link 6, which is on joint 5's axis. About joint 4 the two are opposite to one another there.
        """
        X_23, X_34, X_45, X_56 = (Pose(np.array(link.pos), np.array(link.quat)) for link in self.links[2:6])
        p_4S, p_4W = (X_23 @ X_34).inverse().p, (X_45 @ X_56).p
        return float(np.arctan2(-p_4S[1], -p_4S[0]) - np.arctan2(p_4W[1], p_4W[0]))

    def add_to(self, spec: mujoco.MjSpec) -> mujoco.MjsBody:
        """Add the arm at the world's origin.

        Args:
            spec: the model under construction.

        Returns:
            The last link; the flange is `flange` along its z axis.
        """
        body = spec.worldbody.add_body(name=f"{self.name}_link0")
        _draw(body, self.base, self.dark)
        for i, link in enumerate(self.links):
            body = body.add_body(name=f"{self.name}_link{i + 1}", pos=link.pos, quat=link.quat, gravcomp=True)
            body.mass, body.ipos, body.fullinertia = link.mass, link.com, link.inertia
            body.explicitinertial = True
            body.add_joint(
                name=self.joints[i], type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1), limited=True,
                range=(self.limits.lower[i], self.limits.upper[i]),
                damping=self.joint_damping, armature=self.armature,
            )  # fmt: skip
            _draw(body, link.capsules, self.shell)
            _draw_ring(body, link.ring_radius, self.accent if link.is_accented else self.dark)
        return body


def _draw(body: mujoco.MjsBody, capsules: tuple[Capsule, ...], rgba: Colour) -> None:
    for radius, ends in capsules:
        # contype and conaffinity 0: the arm touches nothing, only its tool does
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=ends, size=(radius, 0, 0), rgba=rgba,
            contype=0, conaffinity=0, mass=0,
        )  # fmt: skip


def _draw_ring(body: mujoco.MjsBody, radius: float, rgba: Colour) -> None:
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=(radius, 0, 0), rgba=rgba, contype=0, conaffinity=0,
        fromto=(0, 0, -RING_HALF_LENGTH, 0, 0, RING_HALF_LENGTH), mass=0,
    )  # fmt: skip
