"""The palletizing cell as a ROS 2 node: it stands in for the robot driver, the gripper and the camera."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

from pack_interfaces.srv import GripperCommand, LayOnTable, RemoveBox, ReplacePallet, ResetCell, SpawnBox
from pydantic import Field
from std_srvs.srv import Trigger

from pack_core.errors import PackError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.calibration import known_cell
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import describe_robot, fixed_frames
from pack_core.palletizing.orders.box_stream import box_stream, listed_items, shipped_lists
from pack_core.robots.kr210 import LIMITS
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.conversions import from_pose
from pack_core.ros.messages.palletizing import from_simulated
from pack_sim.palletizing.arrivals import ArrivalConfig, Arrivals
from pack_sim.palletizing.crossings import visitors_of
from pack_sim.palletizing.infeed import ArrivingBox
from pack_sim.palletizing.overhead_camera import PalletCameraConfig, Snapshot, camera_of
from pack_sim.palletizing.place_scanner import PlaceScannerConfig
from pack_sim.palletizing.ros.publishers import CellPublisher, ScanPublisher
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig
from pack_sim.palletizing.visitor_sensor import VisitorSensor, VisitorSensorConfig
from pack_sim.ros.camera_publisher import CameraPublisher
from pack_sim.ros.physics_node import Pacing, PhysicsNode, run_sim_with_camera


class PalletSimNodeConfig(PalletSimulatorConfig, Pacing):
    """Parameters of the node `sim` of the palletizing cell."""

    seed: int = Field(default=0, ge=0, description="of where boxes arrive, and where the arm really stands")
    preset: str = Field(default="rigid", description="of config/presets/palletizing")
    calibration: str = Field(
        default="", description="calibration file; the driver compensates the gears as it says. Empty: none"
    )
    camera: PalletCameraConfig = PalletCameraConfig()
    visitors: str = Field(
        default="", description="who comes near: a file of config/visitors, or `random`. Empty: nobody"
    )
    sensor: VisitorSensorConfig = VisitorSensorConfig()
    scanner: PlaceScannerConfig = PlaceScannerConfig()
    arrivals: ArrivalConfig = ArrivalConfig()


class PalletSimNode(PhysicsNode):
    """The palletizing cell's driver and gripper, and its camera in a thread of its own."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._config = self.read_parameters(PalletSimNodeConfig, self.change_pace)
        self._cell = palletizing_cell(self._config.preset)
        known = known_cell(self._config.preset, self._config.calibration).calibration
        self._assumed = None if known is None else known.gears
        self._publisher = CellPublisher(self, self._config.timestep)
        self._simulator = self._new_simulator(self._config.seed)
        self._publisher.publish_boxes(self._simulator.boxes)
        # intrinsics are published as the data sheet has them
        intrinsics = camera_of(self._simulator.nominal, self._config.camera)
        self._camera = CameraPublisher[Snapshot](self, contracts.IMAGE, contracts.CAMERA_INFO, intrinsics)
        self._camera.open(self._simulator.open_camera(self._config.camera))
        self._exposure: float | None = None
        """When the frame that was asked for is exposed [s]; None: none was."""
        scanner = self._simulator.open_scanner(self._config.scanner)
        self._scans = ScanPublisher(self, scanner, self._cell.scanned)
        self.show(describe_robot(self._cell)).fix(fixed_frames(self._simulator.cell))
        services = (
            (contracts.GRIPPER_COMMAND, self._command_gripper),
            (contracts.SPAWN_BOX, self._spawn),
            (contracts.LAY_ON_TABLE, self._lay),
            (contracts.REMOVE_BOX, self._remove),
            (contracts.RESET, self._reset),
            (contracts.TRIGGER, self._trigger),
            *((contracts.SCANS[place][0], partial(self._scan, place)) for place in self._cell.scanned),
            *(
                ()
                if self._cell.shift is None
                else ((contracts.SEND_BOX, self._send_box), (contracts.REPLACE_PALLET, self._replace_pallet))
            ),
        )
        factor = self._config.real_time_factor
        self.start(motion.SETPOINTS, "motion", LIMITS.names, services, factor, self._camera)

    @property
    def simulator(self) -> PalletSimulator:
        """The simulated cell; a new object after every reset."""
        return self._simulator

    def advance(self) -> float:
        self._publisher.step(self._simulator)
        if self._exposure is not None and self._simulator.time >= self._exposure:
            reason = self._camera.expose(self._simulator.time, self._simulator.snapshot())
            # A frame that comes while the last picture is still being drawn is lost; the next one is taken.
            self._exposure = self._exposure + 1.0 / self._config.camera.rate if reason else None
        if (seen := self._sensor.observe(self._simulator.time)) is not None:
            self._publisher.publish_obstacles(seen)
        return self._publisher.period

    def _command_gripper(
        self, request: GripperCommand.Request, response: GripperCommand.Response
    ) -> GripperCommand.Response:
        with self.lock:
            gripper = self._simulator.gripper
            gripper.close() if request.close else gripper.open()
        response.success = True
        return response

    def _spawn(self, request: SpawnBox.Request, response: SpawnBox.Response) -> SpawnBox.Response:
        try:
            with self.lock:
                self._simulator.spawn(_body_in(request))
        except PackError as error:
            response.message = str(error)
        return self._after_change(response)

    def _lay(self, request: LayOnTable.Request, response: LayOnTable.Response) -> LayOnTable.Response:
        try:
            with self.lock:
                self._simulator.lay(_body_in(request), from_pose(request.pose))
        except PackError as error:
            response.message = str(error)
        return self._after_change(response)

    def _remove(self, request: RemoveBox.Request, response: RemoveBox.Response) -> RemoveBox.Response:
        try:
            with self.lock:
                self._simulator.remove(request.name)
        except PackError as error:
            response.message = str(error)
        return self._after_change(response)

    def _reset(self, request: ResetCell.Request, response: ResetCell.Response) -> ResetCell.Response:
        with self.lock:
            time = self._simulator.time
            self._simulator = self._new_simulator(request.seed, time, frozenset(request.come))
            self.release()
            try:
                for message in request.standing:
                    self._simulator.spawn(*from_simulated(message))
            except PackError as error:
                response.message = str(error)
        return self._after_change(response)

    def _new_simulator(
        self, seed: int, time: float = 0.0, come: frozenset[str] = frozenset()
    ) -> PalletSimulator:
        """A simulator for a seed; a real cell stays the one that was calibrated, whatever arrives in it.

        Args:
            seed: of what arrives.
            time: what its clock shows [s].
            come: names of boxes that have come on the conveyor already.
        """
        errors_of = None if self._cell.imperfections.camera is None else self._config.seed
        visitors = visitors_of(self._config.visitors, seed)
        self._sensor = VisitorSensor(visitors, self._config.sensor, self._cell.arm.X_WB.p, seed)
        return PalletSimulator(
            self._cell, self._config, seed, time, assumed=self._assumed, errors_of=errors_of,
            visitors=visitors, arrivals=self._arrivals(seed, come),
        )  # fmt: skip

    def _arrivals(self, seed: int, come: frozenset[str]) -> Iterable[ArrivingBox]:
        """What comes on the conveyor of a cell that has one."""
        if self._cell.shift is None:
            return ()
        items = listed_items(shipped_lists())
        return Arrivals(items, box_stream(items, seed), self._config.arrivals, seed, come)

    def _after_change(self, response: Any) -> Any:
        response.success = not response.message
        self._publisher.publish_boxes(self._simulator.boxes)  # of a reset that fails some may be there
        return response

    def _send_box(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self.lock:
            self._simulator.send_box()
        response.success = True
        return response

    def _replace_pallet(
        self, request: ReplacePallet.Request, response: ReplacePallet.Response
    ) -> ReplacePallet.Response:
        if request.place not in self._cell.pallets:
            response.message = f"place is '{request.place}'; allowed: {', '.join(self._cell.pallets)}"
            return response
        with self.lock:
            self._simulator.take_pallet(request.place, request.boxes)
        return self._after_change(response)

    def _trigger(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        camera = self._config.camera
        with self.lock:
            if camera.rate:  # `advance` takes the frame, also one that is due now
                self._exposure, response.success = camera.exposure_time(self._simulator.time), True
                return response
            snapshot = self._simulator.snapshot()
        response.message = self._camera.expose(snapshot.time, snapshot)
        response.success = not response.message
        return response

    def _scan(self, place: str, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self.lock:
            still = self._simulator.still()
        self._scans.publish(place, still)
        response.success = True
        return response


def _body_in(request: SpawnBox.Request | LayOnTable.Request) -> BoxBody:
    """What a request brings; raises PackError where it cannot be."""
    x, y, z = request.size.tolist()
    return BoxBody(request.name, (x, y, z), request.mass)


def main() -> int:
    """Entry point of `pallet_sim_node`."""
    return run_sim_with_camera(PalletSimNode)
