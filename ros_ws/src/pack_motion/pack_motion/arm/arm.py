"""The facts of an arm that motion planning and tracking need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.kinematics.chain import SerialChain
from pack_core.kinematics.inverse import InverseKinematics
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array
from pack_motion.arm.body_boxes import BodyBoxes
from pack_motion.arm.fingers import Fingers

JERK_TIME = 0.1
"""Time in which a joint reaches its full acceleration [s]; arms' jerk limits are not published."""


@dataclass(frozen=True)
class MotionArm:
    """An arm with its tool.

    Attributes:
        chain: forward kinematics in the world frame.
        inverse: inverse kinematics of the same chain.
        limits: limits of its joints.
        home: joint positions at rest `(n,)` [rad].
        bodies: boxes around all shapes that can touch something, without those of the fingers.
        fingers: boxes around the fingers, for a gripper that has them.
        base: boxes around the base, which the arm could hit; None: the arm is not checked against itself.
    """

    chain: SerialChain
    inverse: InverseKinematics
    limits: JointLimits
    home: Array
    bodies: BodyBoxes
    fingers: Fingers | None = None
    base: BodyBoxes | None = None

    def bodies_at(self, opening: float) -> BodyBoxes:
        """Boxes around all shapes of the arm, with the fingers `opening` [m] apart."""
        return self.bodies if self.fingers is None else self.bodies.joined(self.fingers.at(opening))

    @property
    def jerk(self) -> Array:
        """Largest jerk of each joint `(n,)` [rad/s^3]."""
        return np.asarray(self.limits.acceleration / JERK_TIME)
