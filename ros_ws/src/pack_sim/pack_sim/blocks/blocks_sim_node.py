"""The blocks cell as a ROS 2 node: it stands in for the drivers of arm and gripper, and for the camera."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pack_interfaces.srv import JawCommand, ResetScene
from pydantic import Field
from std_srvs.srv import Trigger

from pack_core.blocks import gripper
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import describe_robot, fixed_frames
from pack_core.blocks.problem import Problem
from pack_core.blocks.problem_file import load_problem, parse_problem
from pack_core.errors import PackError
from pack_core.paths import config_path
from pack_core.robots.ur10e import LIMITS
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion
from pack_core.ros.messages.blocks import to_tags
from pack_core.rotations import Array
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.blocks.ros.publishers import BlocksPublisher
from pack_sim.blocks.simulator import BlocksSimulator, BlocksSimulatorConfig
from pack_sim.ros.camera_publisher import CameraPublisher
from pack_sim.ros.physics_node import Pacing, PhysicsNode, run_sim_with_camera


class BlocksSimNodeConfig(BlocksSimulatorConfig, Pacing):
    """Parameters of the node `sim` of the blocks cell."""

    problem: str = Field(
        default="", description="a problem file; empty: config/scenarios/blocks/example.yaml"
    )
    shadows: bool = Field(default=False, description="in the camera's pictures; they take twice as long")


class BlocksSimNode(PhysicsNode):
    """The blocks cell's drivers of arm and gripper, and its camera in a thread of its own."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._config = self.read_parameters(BlocksSimNodeConfig, self.change_pace)
        self._cell, self._finger_commands = blocks_cell(), 0
        self._publisher = BlocksPublisher(self, self._config.timestep)
        self._tags = self.advertise(contracts.TAGS)
        intrinsics = self._cell.camera.pinhole
        self._camera = CameraPublisher[Array](self, contracts.IMAGE, contracts.CAMERA_INFO, intrinsics)
        path = self._config.problem or config_path("scenarios", "blocks", "example.yaml")
        self._simulator = self._build(load_problem(Path(path), self._cell), 0.0)
        self.show(describe_robot(self._cell)).fix(fixed_frames(self._cell))
        services = (
            (contracts.JAW_COMMAND, self._command_fingers),
            (contracts.TRIGGER, self._trigger),
            (contracts.RESET, self._reset),
        )
        factor = self._config.real_time_factor
        self.start(motion.SETPOINTS, "motion", LIMITS.names, services, factor, self._camera)

    @property
    def simulator(self) -> BlocksSimulator:
        """The cell in motion."""
        return self._simulator

    def advance(self) -> float:
        self._publisher.step(self._simulator, self._finger_commands)
        return self._publisher.period

    def _build(self, problem: Problem, start: float) -> BlocksSimulator:
        tags = {block.id: number for number, block in enumerate(problem.blocks)}
        timestep, shadows = self._config.timestep, self._config.shadows
        self._camera.open(OverheadCamera(self._cell, tags, timestep, shadows=shadows, sizes=problem.sizes))
        self._tags.publish(to_tags(tags, problem.sizes))
        return BlocksSimulator(self._cell, tags, problem.starts, self._config, start, problem.sizes)

    def _command_fingers(
        self, request: JawCommand.Request, response: JawCommand.Response
    ) -> JawCommand.Response:
        try:
            with self.lock:
                self._simulator.fingers.command(gripper.FingerCommand(request.opening, request.force))
                self._finger_commands += 1
        except PackError as error:
            response.message = str(error)
        response.success, response.command = not response.message, self._finger_commands
        return response

    def _trigger(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self.lock:
            moment, snapshot = self._simulator.time, self._simulator.snapshot()
        response.message = self._camera.expose(moment, snapshot)
        response.success = not response.message
        return response

    def _reset(self, request: ResetScene.Request, response: ResetScene.Response) -> ResetScene.Response:
        try:
            problem = parse_problem(request.scene, "request", self._cell)
            with self.lock:
                self._simulator = self._build(problem, self._simulator.time)
                self.release()
        except PackError as error:
            response.message = str(error)
        response.success = not response.message
        return response


def main() -> int:
    """Entry point of `blocks_sim_node`."""
    return run_sim_with_camera(BlocksSimNode)
