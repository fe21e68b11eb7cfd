"""The blocks cell as a ROS 2 node: it stands in for the drivers of arm and gripper, and for the camera."""

from __future__ import annotations

import os
import threading
import time
from pathlib import Path
from typing import Any

from pack_interfaces.srv import JawCommand, ResetScene
from pydantic import Field
from rclpy.callback_groups import ReentrantCallbackGroup
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from pack_core import jaw
from pack_core.cells.blocks import blocks_cell
from pack_core.errors import MessageError, PackError
from pack_core.paths import config_path
from pack_core.rearrangement.problem import Problem
from pack_core.rearrangement.problem_file import load_problem, parse_problem
from pack_core.robots.ur10e import LIMITS
from pack_core.ros.block_messages import to_tags
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import blocks as contracts
from pack_core.ros.contracts import motion, shared
from pack_core.ros.joint_messages import from_trajectory
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_sim.blocks.ros.blocks_publisher import BLOCK, BlocksPublisher
from pack_sim.blocks.ros.camera_publisher import CameraPublisher
from pack_sim.blocks.simulator import BlocksSimulator, BlocksSimulatorConfig
from pack_sim.pacing import Pacer


class BlocksSimNodeConfig(BlocksSimulatorConfig):
    """Parameters of the node `sim` of the blocks cell."""

    real_time_factor: float = Field(
        default=1.0, ge=0, le=100, description="1: real time, 0: as fast as it can"
    )
    problem: str = Field(
        default="", description="a problem file; empty: config/scenarios/blocks_example.yaml"
    )
    shadows: bool = Field(default=False, description="in the camera's pictures; they take twice as long")


class BlocksSimNode(CellNode):
    """Runs the physics in a thread of its own, the camera in another; the executor only takes commands."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sim", **kwargs)
        self._config = read_parameters(self, BlocksSimNodeConfig)
        self._cell = blocks_cell()
        self._lock, self._stopped = threading.Lock(), threading.Event()
        self._is_abandoned, self._jaw_commands = False, 0
        self._publisher = BlocksPublisher(self)
        self._factor = self.advertise(shared.REAL_TIME_FACTOR)
        self._tags = self.advertise(contracts.TAGS)
        self._camera = CameraPublisher(self, self._cell, self._config.timestep, shadows=self._config.shadows)
        path = self._config.problem or config_path("scenarios", "blocks_example.yaml")
        self._simulator = self._build(load_problem(Path(path)), 0.0)
        self.listen(motion.SETPOINTS, self._on_setpoints)
        group = ReentrantCallbackGroup()
        for contract, serve in (
            (contracts.JAW_COMMAND, self._command_jaw),
            (contracts.TRIGGER, self._trigger),
            (contracts.RESET, self._reset),
        ):
            self.create_service(contract.type, contract.name, serve, callback_group=group)
        self.watch(("motion",), self._on_peer)
        self._thread = threading.Thread(target=self._run_until_shutdown, name="physics")
        self._thread.start()

    @property
    def simulator(self) -> BlocksSimulator:
        """The cell in motion."""
        return self._simulator

    def destroy_node(self) -> None:
        """Stop the physics and the camera, then the node."""
        self._stopped.set()
        self._thread.join()
        self._camera.close()
        super().destroy_node()

    def _build(self, problem: Problem, start: float) -> BlocksSimulator:
        tags = {block.id: number for number, block in enumerate(problem.blocks)}
        self._camera.open(tags)
        self._tags.publish(to_tags(tags))
        return BlocksSimulator(self._cell, tags, problem.starts, self._config, start)

    def _run_until_shutdown(self) -> None:
        try:
            self._run()
        except Exception:
            if self.context.ok():
                raise

    def _run(self) -> None:
        pacer, reported = Pacer(self._config.real_time_factor), time.monotonic()
        while not self._stopped.is_set():
            with self._lock:
                self._publisher.step(self._simulator, self._jaw_commands)
            delay = pacer.delay(BLOCK * self._config.timestep)
            self._stopped.wait(delay) if delay > 0 else time.sleep(0)
            if time.monotonic() - reported > 1.0:
                reported = time.monotonic()
                self._factor.publish(Float64(data=pacer.achieved()))

    def _on_setpoints(self, message: JointTrajectory) -> None:
        if self._is_abandoned:
            raise MessageError("their sender has fallen silent since; the arm holds")
        reference = from_trajectory(message, LIMITS.names)
        with self._lock:
            self._simulator.accept(reference)

    def _on_peer(self, _: str, is_alive: bool) -> None:
        self._is_abandoned = not is_alive
        if self._is_abandoned:
            with self._lock:
                self._simulator.follower.drop()

    def _command_jaw(self, request: JawCommand.Request, response: JawCommand.Response) -> JawCommand.Response:
        try:
            with self._lock:
                self._simulator.jaw.command(jaw.JawCommand(request.opening, request.force))
                self._jaw_commands += 1
        except PackError as error:
            response.message = str(error)
        response.success, response.command = not response.message, self._jaw_commands
        return response

    def _trigger(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            moment, snapshot = self._simulator.time, self._simulator.snapshot()
        response.message = self._camera.expose(moment, snapshot)
        response.success = not response.message
        return response

    def _reset(self, request: ResetScene.Request, response: ResetScene.Response) -> ResetScene.Response:
        try:
            problem = parse_problem(request.scene, "request")
            with self._lock:
                self._simulator = self._build(problem, self._simulator.time)
        except PackError as error:
            response.message = str(error)
        response.success = not response.message
        return response


def main() -> int:
    """Entry point of `blocks_sim_node`."""
    os.environ.setdefault("LP_NUM_THREADS", "1")  # drawing in software leaves the other cores to the physics
    return run_node(BlocksSimNode)
