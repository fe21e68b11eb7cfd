"""An arm, as motion needs it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.kinematics.chain import SerialChain
from pack_core.kinematics.inverse import InverseKinematics
from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array
from pack_motion.arm.body_boxes import BodyBoxes
from pack_motion.arm.fingers import Fingers

JERK_TIME = 0.1
"""In which a joint reaches its full acceleration [s]; arms' jerk limits are not published."""


@dataclass(frozen=True)
class MotionArm:
    """An arm with its tool.

    Attributes:
        chain: its kinematics, in the world.
        inverse: of the same chain.
        limits: of its joints.
        home: its posture at rest `(n,)` [rad].
        bodies: boxes around everything it can touch with, but for fingers.
        fingers: of a gripper that has them.
        base: boxes around what it stands on and could hit; with it, the arm is checked against itself.
    """

    chain: SerialChain
    inverse: InverseKinematics
    limits: JointLimits
    home: Array
    bodies: BodyBoxes
    fingers: Fingers | None = None
    base: BodyBoxes | None = None

    def bodies_at(self, opening: float) -> BodyBoxes:
        """Boxes around everything, the fingers `opening` [m] apart."""
        return self.bodies if self.fingers is None else self.bodies.joined(self.fingers.at(opening))

    @property
    def jerk(self) -> Array:
        """Of each joint, at most `(n,)` [rad/s^3]."""
        return np.asarray(self.limits.acceleration / JERK_TIME)
