"""The simulator as a ROS 2 node that replaces the robot driver, the pump and the cameras."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pack_interfaces.srv import GripperCommand, PresentObject, ResetScene
from pydantic import Field
from std_msgs.msg import String

from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.model import describe_robot, fixed_frames
from pack_core.packing.objects import parse_object
from pack_core.packing.packing_list import parse_list
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene, parse_scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.packing import read_packing_cell
from pack_core.ros.run import run_node
from pack_core.text.yaml_text import parse_yaml
from pack_sim.packing.ros.depth_publisher import DepthPublisher
from pack_sim.packing.ros.sensor_publisher import SensorPublisher
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator, SimulatorConfig
from pack_sim.ros.physics_node import Pacing, PhysicsNode


class PackingSimNodeConfig(SimulatorConfig, Pacing):
    """Parameters of the node `sim`."""

    seed: int = Field(default=0, ge=0, description="seed of the scene and of the sensors' noise")
    scene: str = Field(default="", description="a scene file; empty: a generated one")


class PackingSimNode(PhysicsNode):
    """Node `sim` of the packing cell: driver, pump, and motion capture or depth cameras."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._config = self.read_parameters(PackingSimNodeConfig, self._change)
        self._cell = read_packing_cell(self)
        self._sensors = SensorPublisher(self, self._config.timestep, self._cell.robot.arm.joints)
        has_depth = self._cell.perception is Perception.DEPTH
        self._depth = DepthPublisher(self, self._cell) if has_depth else None
        self._told = [self.advertise(contracts.SIM_DESCRIPTION)]
        if self._depth is None:  # else perception describes the cell
            self._told.append(self.advertise(contracts.DESCRIPTION))
        self._shown = self.show(describe_robot(self._cell))
        self._simulator = self._build(self._first_scene(), self._config.seed, 0.0)
        services = (
            (contracts.RESET, self._reset),
            (contracts.GRIPPER_COMMAND, self._command_gripper),
            (contracts.PRESENT, self._present),
        )
        joints = self._cell.robot.arm.joints
        factor = self._config.real_time_factor
        self.start(contracts.SETPOINTS, "mpc", joints, services, factor, self._depth)

    def _change(self, config: PackingSimNodeConfig) -> None:
        self.change_pace(config)
        with self.lock:
            self._config = config
            self._simulator.change_sensors(config)

    @property
    def simulator(self) -> Simulator:
        """The simulator of the current scene."""
        return self._simulator

    def advance(self) -> float:
        """Advance by a block of steps, publish what is due, and return the simulated time that passed [s]."""
        self._sensors.step(self._simulator)
        if self._depth is not None:
            self._depth.step(self._simulator)
        return self._sensors.period

    def _first_scene(self) -> Scene:
        if self._config.scene:
            return load_scene(Path(self._config.scene), self._cell)
        return generate_scene(self._config.seed, self._cell)

    def _build(self, scene: Scene, seed: int, start: float) -> Simulator:
        simulator = Simulator(self._cell, scene, self._config, np.random.default_rng(seed), start)
        self._describe(simulator)
        self._shown.fix(fixed_frames(self._cell, scene.container))
        if self._depth is not None:
            self._depth.open(seed, start)
        return simulator

    def _describe(self, simulator: Simulator) -> None:
        for publisher in self._told:
            publisher.publish(String(data=simulator.description.to_yaml()))

    def _reset(self, request: ResetScene.Request, response: ResetScene.Response) -> ResetScene.Response:
        try:
            scene = wanted_scene(request, self._cell)
            with self.lock:
                self._simulator = self._build(scene, request.seed, self._simulator.time)
                self.release()
        except PackError as error:
            response.message = str(error)
        response.success = not response.message
        return response

    def _present(
        self, request: PresentObject.Request, response: PresentObject.Response
    ) -> PresentObject.Response:
        try:
            item = parse_object(request.object, "request")
            with self.lock:
                response.message = self._simulator.present(item)
                if not response.message:
                    self._describe(self._simulator)
        except PackError as error:
            response.message = str(error)
        response.success = not response.message
        return response

    def _command_gripper(
        self, request: GripperCommand.Request, response: GripperCommand.Response
    ) -> GripperCommand.Response:
        with self.lock:
            if request.close:
                response.message = self._simulator.grip()
            else:
                self._simulator.release()
        response.success = not response.message
        return response


def wanted_scene(request: ResetScene.Request, cell: PackingCell) -> Scene:
    """The scene that a request describes; for a packing list an empty container, and its first object.

    Raises:
        PackError: the text is neither, or the cell cannot pack what it has.
    """
    if not request.scene:
        return generate_scene(request.seed, cell)
    found = parse_yaml(request.scene, "request")
    if isinstance(found, Mapping) and "new_object" not in found:
        return parse_list(request.scene, "request without 'new_object', a packing list", cell).start(cell)
    return parse_scene(request.scene, "request", cell)


def main() -> int:
    """Entry point of `sim_node`."""
    return run_node(PackingSimNode)
