"""The palletizing cell as a ROS 2 node: it stands in for the robot driver, the gripper and the camera."""

from __future__ import annotations

import os
import threading
import time
from typing import Any

from pack_interfaces.srv import GripperCommand, RemoveBox, ResetCell, SpawnBox
from pydantic import Field
from rclpy.callback_groups import ReentrantCallbackGroup
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from pack_core.cells.palletizing import palletizing_cell
from pack_core.errors import MessageError, PackError
from pack_core.robots.kr210 import LIMITS
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import motion, shared
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.joint_messages import from_trajectory
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_core.scene.palletizing.box_body import BoxBody
from pack_sim.pacing import Pacer
from pack_sim.palletizing.overhead_camera import OverheadCameraConfig
from pack_sim.palletizing.ros.camera_publisher import CameraPublisher
from pack_sim.palletizing.ros.cell_publisher import BLOCK, CellPublisher
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig


class PalletSimNodeConfig(PalletSimulatorConfig):
    """Parameters of the node `sim` of the palletizing cell."""

    real_time_factor: float = Field(
        default=1.0, ge=0, le=100, description="1: real time, 0: as fast as it can"
    )
    seed: int = Field(default=0, ge=0, description="of where boxes arrive, and where the arm really stands")
    preset: str = Field(
        default="rigid", description="what the arm is like, see config/cells/palletizing.yaml"
    )
    camera: OverheadCameraConfig = OverheadCameraConfig()


class PalletSimNode(CellNode):
    """Runs the physics in a thread of its own, the camera in another; the executor only takes commands."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sim", **kwargs)
        self._config = read_parameters(self, PalletSimNodeConfig)
        self._cell = palletizing_cell(self._config.preset)
        self._lock = threading.Lock()
        self._stopped = threading.Event()
        self._is_abandoned = False
        self._publisher = CellPublisher(self)
        self._factor = self.advertise(shared.REAL_TIME_FACTOR)
        self._simulator = PalletSimulator(self._cell, self._config, self._config.seed)
        self._publisher.publish_boxes(self._simulator.boxes)
        self._camera = CameraPublisher(self, self._cell, self._config.camera)
        self.listen(motion.SETPOINTS, self._on_setpoints)
        group = ReentrantCallbackGroup()
        for contract, serve in (
            (contracts.GRIPPER_COMMAND, self._command_gripper),
            (contracts.SPAWN_BOX, self._spawn),
            (contracts.REMOVE_BOX, self._remove),
            (contracts.RESET, self._reset),
            (contracts.TRIGGER, self._trigger),
        ):
            self.create_service(contract.type, contract.name, serve, callback_group=group)
        self.watch(("motion",), self._on_peer)
        self._thread = threading.Thread(target=self._run_until_shutdown, name="physics")
        self._thread.start()

    @property
    def simulator(self) -> PalletSimulator:
        """The cell in motion."""
        return self._simulator

    def destroy_node(self) -> None:
        """Stop the physics and the camera, then the node."""
        self._stopped.set()
        self._thread.join()
        self._camera.close()
        super().destroy_node()

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
                self._publisher.step(self._simulator)
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

    def _command_gripper(
        self, request: GripperCommand.Request, response: GripperCommand.Response
    ) -> GripperCommand.Response:
        with self._lock:
            gripper = self._simulator.gripper
            gripper.close() if request.close else gripper.open()
        response.success = True
        return response

    def _spawn(self, request: SpawnBox.Request, response: SpawnBox.Response) -> SpawnBox.Response:
        try:
            x, y, z = request.size.tolist()
            box = BoxBody(request.name, (x, y, z), request.mass)
            with self._lock:
                self._simulator.spawn(box)
        except PackError as error:
            response.message = str(error)
        return self._after_change(response)

    def _remove(self, request: RemoveBox.Request, response: RemoveBox.Response) -> RemoveBox.Response:
        try:
            with self._lock:
                self._simulator.remove(request.name)
        except PackError as error:
            response.message = str(error)
        return self._after_change(response)

    def _reset(self, request: ResetCell.Request, response: ResetCell.Response) -> ResetCell.Response:
        with self._lock:
            time = self._simulator.time
            self._simulator = PalletSimulator(self._cell, self._config, request.seed, time)
        return self._after_change(response)

    def _after_change(self, response: Any) -> Any:
        response.success = not response.message
        if response.success:
            self._publisher.publish_boxes(self._simulator.boxes)
        return response

    def _trigger(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            snapshot = self._simulator.snapshot()
        response.success = self._camera.expose(snapshot)
        if not response.success:
            response.message = "the last picture is still being made"
        return response


def main() -> int:
    """Entry point of `pallet_sim_node`."""
    os.environ.setdefault("LP_NUM_THREADS", "1")  # drawing in software leaves the other cores to the physics
    return run_node(PalletSimNode)
