"""The palletizing cell in one process, without ROS, on simulated time: what orders and shifts have in common.

It composes the same cores as the nodes. Pictures and decisions take a stated time on the simulated clock,
never the wall clock, so a run repeats bit for bit on any machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.motion.target import MotionTarget
from pack_core.palletizing.boxes import BoxBody, BoxDetection, ExpectedBox
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.ports import (
    CloseGripper,
    Command,
    DiscardBox,
    OpenGripper,
    PalletObservation,
    PursueTarget,
    ScanPlace,
    SendBox,
    SpawnBox,
    StopArm,
    TakePallet,
    TakePicture,
)
from pack_core.palletizing.scanner import PlaceScan
from pack_core.palletizing.visitors import Visitor
from pack_core.robots.joint_properties import GearCompensation
from pack_lockstep.driven_arm import DrivenArm
from pack_lockstep.palletizing.box_finder import BoxFinder, BoxFinderConfig
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set
from pack_sim.palletizing.infeed import ArrivingBox
from pack_sim.palletizing.place_scanner import PlaceScannerConfig
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig
from pack_sim.palletizing.visitor_sensor import VisitorSensor, VisitorSensorConfig
from pallet_fsm.palletizer_config import PalletizerConfig


class PalletLockstepConfig(Config):
    """Parameters of a run; the parts' own are those of the nodes."""

    period: PositiveFloat = Field(default=0.004, description="between two setpoints for the arm [s]")
    settle: NonNegativeFloat = Field(default=0.5, description="after the order, for the stack to rest [s]")
    motion: str = Field(default="shipped", description="a set of config/motion")
    sight: BoxFinderConfig = BoxFinderConfig()
    simulator: PalletSimulatorConfig = PalletSimulatorConfig()
    palletizer: PalletizerConfig = PalletizerConfig()
    visitors: tuple[Visitor, ...] = Field(default=(), description="who comes near the arm")
    sensor: VisitorSensorConfig = VisitorSensorConfig()
    scanner: PlaceScannerConfig = PlaceScannerConfig()


class SteppedCell:
    """The simulated cell with its arm, camera and scanners, stepped together.

    Args:
        cell: the cell as it is configured.
        known: the cell as it is known.
        config: parameters.
        seed: seed of the poses at which boxes arrive, and of all errors of a real cell.
        rng: generates the noise of detections.
        on_refusal: called with the reason when the driver refuses setpoints.
        assumed: what the driver assumes of the arm's gears; by default what the preset says.
        arrivals: what comes on the conveyor of a cell that has one.
        time: what the clock shows at the start [s].

    Attributes:
        camera_is_silent: whether pictures are asked for in vain.
        on_target: is called with every target that the motion is given, before it is.
    """

    def __init__(
        self, cell: PalletizingCell, known: PalletizingCell, config: PalletLockstepConfig, seed: int,
        rng: np.random.Generator, on_refusal: Callable[[str], None],
        assumed: GearCompensation | None = None, arrivals: Iterable[ArrivingBox] = (), time: float = 0.0,
    ) -> None:  # fmt: skip
        self._known, self._config, self._rng = known, config, rng
        self.simulator = PalletSimulator(
            cell, config.simulator, seed, time, assumed, config.visitors, arrivals=arrivals
        )
        self._sensor = VisitorSensor(config.visitors, config.sensor, cell.arm.X_WB.p, seed)
        self._scanner = self.simulator.open_scanner(config.scanner)
        self._scans: dict[str, PlaceScan] = {}
        arm, q = load_arm("palletizing"), np.array(cell.arm.home)
        self.motion = MotionController(arm, motion_set(config.motion), self.simulator.time, q)
        self.arm = DrivenArm(self.motion, self.simulator, q, config.period, on_refusal)
        self.camera_is_silent = False
        self._spawned = ""
        self._detection: BoxDetection | None = None
        self._exposure: tuple[float, ExpectedBox] | None = None
        self._pending: tuple[float, BoxDetection] | None = None
        self.on_target: Callable[[MotionTarget], None] = lambda target: None

    def scan(self, place: str) -> PlaceScan:
        """A scan of a place, at once."""
        return self._scanner.scan(place, self.simulator.still())

    def observe(self) -> PalletObservation:
        """What is known now."""
        simulator = self.simulator
        if self._pending is not None and simulator.time >= self._pending[0]:
            self._detection, self._pending = self._pending[1], None
        samples = () if self.arm.sample is None else (self.arm.sample,)
        return PalletObservation(
            simulator.time, self.motion.status(), simulator.gripper.state, self._spawned, self._detection,
            self._answered(), samples=samples, infeed=simulator.infeed, taken=simulator.taken,
        )  # fmt: skip

    def apply(self, command: Command) -> bool:
        """Carry a command out; whether the motion took it, for a target."""
        simulator = self.simulator
        match command:
            case SpawnBox(name, dims, mass):
                simulator.spawn(BoxBody(name, dims, mass))
                self._spawned = name
            case DiscardBox(name):
                if any(box.name == name for box in simulator.boxes):
                    simulator.remove(name)
            case SendBox():
                simulator.send_box()
            case TakePallet(place, boxes):
                simulator.take_pallet(place, boxes)
            case TakePicture() | ScanPlace():
                self._look(command)
            case _:
                return self._move(command)
        return True

    def _move(self, command: Command) -> bool:
        """Carry out what arm and gripper are to do; whether the motion took it, for a target."""
        match command:
            case PursueTarget(target):
                self.on_target(target)
                return self.motion.command(target).is_accepted
            case StopArm():
                self.motion.stop()
            case CloseGripper():
                self.simulator.gripper.close()
            case OpenGripper():
                self.simulator.gripper.open()
        return True

    def expose(self, finder: BoxFinder) -> None:
        """Take the picture that was asked for, once its time has come; the result is known a little later."""
        if self._exposure is not None and self.simulator.time >= self._exposure[0]:
            detection = finder.detect(self._exposure[1], self.simulator)
            self._pending = self.simulator.time + self._latency(), detection
            self._exposure = None

    def advance(self) -> None:
        """Advance motion and physics by one period."""
        seen = self._sensor.observe(self.simulator.time)
        if seen is not None:
            self.motion.observe(seen.obstacles, seen.time)
        self.arm.advance()

    def _look(self, command: TakePicture | ScanPlace) -> None:
        """Ask for a picture, or scan a place; the result is known a little later."""
        if isinstance(command, ScanPlace):
            self._scans[command.place] = self.scan(command.place)
        elif not self.camera_is_silent:
            time = self._config.sight.camera.exposure_time(self.simulator.time)
            self._exposure = time, command.expected

    def _answered(self) -> tuple[PlaceScan, ...]:
        """The scans whose results have come by now."""
        latest = self.simulator.time - self._config.scanner.latency
        return tuple(scan for scan in self._scans.values() if scan.time <= latest)

    def _latency(self) -> float:
        """Time from a picture to its detection [s]."""
        camera = self._known.imperfections.camera
        return self._config.sight.latency if camera is None else float(self._rng.uniform(*camera.latency))
