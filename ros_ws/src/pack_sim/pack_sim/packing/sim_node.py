"""The simulator as a ROS 2 node: it stands in for the robot driver, the pump and the cameras."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
from pack_interfaces.srv import GripperCommand, ResetScene
from pydantic import Field
from rclpy.callback_groups import ReentrantCallbackGroup
from std_msgs.msg import Float64, String
from trajectory_msgs.msg import JointTrajectory

from pack_core.errors import MessageError
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.conversions import from_setpoints
from pack_core.ros.packing_cell import read_packing_cell
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_core.scene.scene import Scene
from pack_core.scene.scene_file import load_scene, parse_scene
from pack_sim.pacing import Pacer
from pack_sim.packing.ros.sensor_publisher import BLOCK, SensorPublisher
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator, SimulatorConfig


class SimNodeConfig(SimulatorConfig):
    """Parameters of the node `sim`."""

    real_time_factor: float = Field(
        default=1.0, ge=0, le=100, description="1: real time, 0: as fast as it can"
    )
    seed: int = Field(default=0, ge=0, description="seed of the scene and of the sensors' noise")
    scene: str = Field(default="", description="a scene file; empty: a generated one")


class SimNode(CellNode):
    """Runs the physics in a thread of its own; the executor only takes commands."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sim", **kwargs)
        self._config = read_parameters(self, SimNodeConfig)
        self._cell = read_packing_cell(self)
        self._lock = threading.Lock()
        self._stopped = threading.Event()
        self._is_abandoned = False
        self._sensors = SensorPublisher(self)
        self._description = self.advertise(contracts.DESCRIPTION)
        self._factor = self.advertise(shared.REAL_TIME_FACTOR)
        self._simulator = self._build(self._first_scene(), self._config.seed, 0.0)
        self.listen(contracts.SETPOINTS, self._on_setpoints)
        group = ReentrantCallbackGroup()
        for contract, serve in (
            (contracts.RESET, self._reset),
            (contracts.GRIPPER_COMMAND, self._command_gripper),
        ):
            self.create_service(contract.type, contract.name, serve, callback_group=group)
        self.watch(("mpc",), self._on_peer)
        self._thread = threading.Thread(target=self._run_until_shutdown, name="physics")
        self._thread.start()

    @property
    def simulator(self) -> Simulator:
        """The scene in motion."""
        return self._simulator

    def destroy_node(self) -> None:
        """Stop the physics, then the node."""
        self._stopped.set()
        self._thread.join()
        super().destroy_node()

    def _first_scene(self) -> Scene:
        if self._config.scene:
            return load_scene(Path(self._config.scene))
        return generate_scene(self._config.seed, self._cell)

    def _build(self, scene: Scene, seed: int, start: float) -> Simulator:
        simulator = Simulator(self._cell, scene, self._config, np.random.default_rng(seed), start)
        self._description.publish(String(data=simulator.description.to_yaml()))
        return simulator

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
                self._sensors.step(self._simulator)
            delay = pacer.delay(BLOCK * self._config.timestep)
            self._stopped.wait(delay) if delay > 0 else time.sleep(0)
            if time.monotonic() - reported > 1.0:
                reported = time.monotonic()
                self._factor.publish(Float64(data=pacer.achieved()))

    def _on_setpoints(self, message: JointTrajectory) -> None:
        if self._is_abandoned:
            raise MessageError("their sender has fallen silent since; the arm holds")
        setpoints = from_setpoints(message)
        with self._lock:
            self._simulator.accept(setpoints)

    def _on_peer(self, _: str, is_alive: bool) -> None:
        self._is_abandoned = not is_alive
        if self._is_abandoned:
            with self._lock:
                self._simulator.controller.drop()

    def _reset(self, request: ResetScene.Request, response: ResetScene.Response) -> ResetScene.Response:
        try:
            scene = (
                parse_scene(request.scene, "request")
                if request.scene
                else generate_scene(request.seed, self._cell)
            )
            with self._lock:
                self._simulator = self._build(scene, request.seed, self._simulator.time)
        except Exception as error:
            response.message = str(error)
            return response
        response.success = True
        return response

    def _command_gripper(
        self, request: GripperCommand.Request, response: GripperCommand.Response
    ) -> GripperCommand.Response:
        with self._lock:
            if request.close:
                response.message = self._simulator.grip()
            else:
                self._simulator.release()
        response.success = not response.message
        return response


def main() -> int:
    """Entry point of `sim_node`."""
    return run_node(SimNode)
