"""What motion planning and tracking need of an arm, and the arms of the cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np

from pack_core.blocks.cell import blocks_cell
from pack_core.errors import ConfigError
from pack_core.kinematics.chain import SerialChain, chain_from_model
from pack_core.kinematics.inverse import InverseKinematics
from pack_core.kinematics.parallel_axes import ParallelAxes
from pack_core.palletizing.arm import arm_kinematics
from pack_core.robots import kr210, robotiq_2f85, ur10e
from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array
from pack_motion.arm.bodies import BodyBoxes, Fingers, boxes_from_model, fingers_from_model, fixed_boxes
from pack_motion.reference.curve import JERK_TIME


@dataclass(frozen=True)
class MotionArm:
    """An arm with its tool.

    Attributes:
        chain: forward kinematics in the world frame.
        inverse: inverse kinematics of the same chain.
        limits: limits of its joints.
        home: joint positions at rest `(n,)` [rad].
        spec: the MuJoCo model of arm and gripper alone, in which the tool's frame is the body `TOOL`.
        joints: names of the joints in that model.
        bodies: boxes around all shapes that can touch something, without those of the fingers.
        fingers: boxes around the fingers, for a gripper that has them.
        base: boxes around the base, which the arm could hit; None: the arm is not checked against itself.
        finger_joints: names of the fingers' joints in the model, each of which goes by half the opening.
    """

    chain: SerialChain
    inverse: InverseKinematics
    limits: JointLimits
    home: Array
    spec: mujoco.MjSpec
    joints: tuple[str, ...]
    bodies: BodyBoxes
    fingers: Fingers | None = None
    base: BodyBoxes | None = None
    finger_joints: tuple[str, ...] = ()

    def bodies_at(self, opening: float) -> BodyBoxes:
        """Boxes around all shapes of the arm, with the fingers `opening` [m] apart."""
        return self.bodies if self.fingers is None else self.bodies.joined(self.fingers.at(opening))

    @property
    def jerk(self) -> Array:
        """Largest jerk of each joint `(n,)` [rad/s^3]."""
        return np.asarray(self.limits.acceleration / JERK_TIME)


TOOL = "tool"


@cache
def load_arm(cell: str) -> MotionArm:
    """The arm of a cell, as configured in `config/cells/<cell>.yaml`.

    Raises:
        ConfigError: this package moves no arm in a cell of this name.
    """
    if cell not in ARMS:
        raise ConfigError(f"no arm for cell '{cell}'; there are: {', '.join(ARMS)}")
    return ARMS[cell]()


def _palletizing() -> MotionArm:
    arm = arm_kinematics()
    bodies = boxes_from_model(arm.model, kr210.JOINTS)
    return MotionArm(arm.chain, arm.inverse, kr210.LIMITS, arm.home, arm.spec, kr210.JOINTS, bodies)


def _blocks() -> MotionArm:
    cell = blocks_cell()
    spec = mujoco.MjSpec()
    flange = ur10e.add_ur10e(spec, cell.robot.base.to_pose(), contype=1, conaffinity=1)
    robotiq_2f85.add_robotiq_2f85(
        flange, spec, pad_friction=cell.gripper.pad_friction, contype=1, conaffinity=1
    )
    model, limits = spec.compile(), ur10e.LIMITS
    chain = chain_from_model(model, ur10e.JOINTS, TOOL)
    inverse = ParallelAxes(chain, limits.lower, limits.upper)
    return MotionArm(
        chain, inverse, limits, np.array(cell.robot.look), spec, ur10e.JOINTS,
        boxes_from_model(model, ur10e.JOINTS, without=robotiq_2f85.FINGERS),
        fingers_from_model(model, len(ur10e.JOINTS) - 1, robotiq_2f85.FINGER_JOINTS),
        fixed_boxes(model, ur10e.BASE),
        robotiq_2f85.FINGER_JOINTS,
    )  # fmt: skip


ARMS: dict[str, Callable[[], MotionArm]] = {"palletizing": _palletizing, "blocks": _blocks}
