"""The simulated blocks cell: MuJoCo physics behind the interfaces of an arm's and a gripper's driver."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.gripper import FingerState
from pack_core.blocks.model import TOOL, arm_model, block_name, build_model
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBES, BlockSizes
from pack_core.bodies import body_pose, set_object_poses
from pack_core.config import Config
from pack_core.joints import JointSample, Setpoints
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS
from pack_core.robots.ur10e import JOINTS, LIMITS
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState
from pack_sim.blocks.gripper_fingers import GripperFingers
from pack_sim.brakes import GentleBrake
from pack_sim.joint_servo import JointServo, in_a_row
from pack_sim.setpoint_follower import SetpointFollower

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
START_OPENING = 0.060
"""Of the gripper [m]."""


class BlocksSimulatorConfig(Config):
    """Parameters of the simulated drivers."""

    timestep: float = Field(default=0.001, gt=0, le=0.001, description="physics and joint servo [s]")
    watchdog: PositiveFloat = Field(default=0.1, description="age at which setpoints are stale [s]")


class BlocksSimulator:
    """Blocks on the table, and an arm that moves them.

    Args:
        cell: the cell's physical facts.
        tags: the number of every block's tag, by the block's id.
        starts: X_WB of every block at the start, by id.
        config: rates and limits.
        time: what the clock shows at the start [s].
        sizes: of the blocks that are not cubes, by id.
    """

    def __init__(
        self,
        cell: BlocksCell,
        tags: Mapping[str, int],
        starts: Mapping[str, PlanarPose],
        config: BlocksSimulatorConfig | None = None,
        time: float = 0.0,
        sizes: BlockSizes = CUBES,
    ) -> None:
        self.cell, self.tags, self._sizes = cell, dict(tags), sizes
        self.config = config or BlocksSimulatorConfig()
        timestep = self.config.timestep
        self.model = build_model(cell, tags, sizes, timestep=timestep)
        self.data = mujoco.MjData(self.model)
        self.data.time = time
        self._q = in_a_row([self.model.joint(name).qposadr[0] for name in JOINTS])
        self._v = in_a_row([self.model.joint(name).dofadr[0] for name in JOINTS])
        self._motors = in_a_row([self.model.actuator(name).id for name in JOINTS])
        brake = GentleBrake(LIMITS, cell.servo.stop_deceleration)
        self.follower = SetpointFollower(LIMITS, self.config.watchdog, brake)
        self._servo = JointServo(arm_model(cell), LIMITS, cell.servo, timestep)
        self.fingers = GripperFingers(self.model, cell.gripper.speed, cell.gripper.force, START_OPENING)
        self._put(starts)
        self.follower.at(
            self.time, self.data.qpos[self._q], self.data.qvel[self._v]
        )  # from here on the arm is held: setpoints from before a reset are refused

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    def accept(self, setpoints: Setpoints) -> None:
        """Pass setpoints to the driver; raises MessageError if they are refused."""
        self.follower.accept(setpoints, self.time)

    def step(self) -> None:
        """Advance by one time step."""
        data = self.data
        q, v = data.qpos[self._q].copy(), data.qvel[self._v].copy()
        data.ctrl[self._motors] = self._servo.torque(q, v, self.follower.at(self.time, q, v))
        self.fingers.update(data)
        mujoco.mj_step(self.model, data)

    def joints(self) -> JointSample:
        """What the joint sensors measure."""
        data = self.data
        return JointSample(
            self.time, data.qpos[self._q].copy(), data.qvel[self._v].copy(), data.ctrl[self._motors].copy()
        )

    def finger_state(self) -> FingerState:
        """What the gripper says."""
        return self.fingers.state(self.data)

    def truth(self) -> SceneState:
        """True poses and twists of all blocks, by id."""
        mujoco.mj_kinematics(self.model, self.data)
        return SceneState(self.time, {block: self._state_of(block) for block in self.tags})

    def tool_pose(self) -> Pose:
        """X_WT, true."""
        mujoco.mj_kinematics(self.model, self.data)
        return body_pose(self.data, TOOL)

    def put(self, block: str, X_WB: Pose) -> None:
        """Put a block somewhere else, at rest, as a hand does."""
        joint = self.model.body(block_name(block)).jntadr[0]
        q, v = self.model.jnt_qposadr[joint], self.model.jnt_dofadr[joint]
        self.data.qpos[q : q + 7] = [*X_WB.p, *X_WB.q]
        self.data.qvel[v : v + 6] = 0.0
        mujoco.mj_forward(self.model, self.data)

    def snapshot(self) -> Array:
        """All that a picture depends on, to be set in another MjData of the same cell."""
        state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, state, STATE)
        return state

    def _put(self, starts: Mapping[str, PlanarPose]) -> None:
        self.data.qpos[self._q] = self.cell.robot.look
        for name in FINGER_JOINTS:
            self.data.joint(name).qpos = 0.5 * START_OPENING
        cube = self.cell.block.cube
        poses = {
            block_name(block): starts[block].pose(0.5 * self._sizes.get(block, cube).z) for block in self.tags
        }
        set_object_poses(self.model, self.data, poses)
        mujoco.mj_forward(self.model, self.data)

    def _state_of(self, block: str) -> ObjectState:
        twist, name = np.empty(6), block_name(block)
        body = self.model.body(name).id
        mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_XBODY, body, twist, 0)
        return ObjectState(body_pose(self.data, name), twist[3:].copy(), twist[:3].copy())
