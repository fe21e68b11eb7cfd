"""The palletizing cell in one process, without ROS, on simulated time.

It composes the same cores as the nodes. Pictures and layouts take a stated time on the simulated clock,
never the wall clock, so a run repeats bit for bit on any machine.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.motion.target import MotionStatus, MotionTarget
from pack_core.palletizing.boxes import BoxBody, BoxDetection, ExpectedBox
from pack_core.palletizing.calibration import CellCalibration
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.ports import (
    CloseGripper,
    Command,
    DiscardBox,
    OpenGripper,
    PalletObservation,
    PursueTarget,
    ScanPlace,
    SpawnBox,
    StopArm,
    TakePicture,
)
from pack_core.palletizing.scanner import PlaceScan
from pack_core.palletizing.visitors import Visitor
from pack_evaluation.palletizing.run import PalletRun
from pack_lockstep.driven_arm import DrivenArm
from pack_lockstep.palletizing.box_finder import BoxFinder, BoxFinderConfig, open_box_finder
from pack_lockstep.palletizing.run_log import PalletRunLog
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.reference.trajectory import JointState
from pack_motion.tracking.config import motion_set
from pack_sim.palletizing.place_scanner import PlaceScannerConfig
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig
from pack_sim.palletizing.visitor_sensor import VisitorSensor, VisitorSensorConfig
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.states import State


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


@dataclass(frozen=True)
class Tick:
    """One cycle of the loop, for logs: state of the machine, box in work, and status of the motion."""

    time: float
    state: State
    box: str
    motion: MotionStatus


class PalletLockstep:
    """Runs one order from start to end.

    Args:
        cell: the cell's physical facts.
        order: the order to build.
        plan: the place of every box.
        config: parameters.
        seed: seed of the poses at which boxes arrive and of the detections' noise.

    Attributes:
        camera_is_silent: whether pictures are asked for in vain.
    """

    def __init__(
        self,
        cell: PalletizingCell,
        order: Order,
        plan: LayoutPlan,
        config: PalletLockstepConfig,
        seed: int,
        calibration: CellCalibration | None = None,
    ) -> None:
        known = cell if calibration is None else calibration.applied(cell)
        assumed = None if calibration is None else calibration.gears
        self._cell, self._config = known, config
        self.simulator = PalletSimulator(
            cell, config.simulator, seed, assumed=assumed, visitors=config.visitors
        )
        self._sensor = VisitorSensor(config.visitors, config.sensor, cell.arm.X_WB.p, seed)
        self._scanner = self.simulator.open_scanner(config.scanner)
        self._scans: dict[str, PlaceScan] = {}
        arm, q = load_arm("palletizing"), np.array(cell.arm.home)
        self.motion = MotionController(arm, motion_set(config.motion), self.simulator.time, q)
        self.palletizer = Palletizer(order, plan, known, config.palletizer, self.simulator.time)
        self._arm = DrivenArm(self.motion, self.simulator, q, config.period, self.palletizer.halt)
        self._log = PalletRunLog(self.simulator, config.period, known)
        self._seed = seed
        self.camera_is_silent = False
        self._rng = np.random.default_rng([seed, zlib.crc32(order.order_id.encode())])
        self._spawned = ""
        self._target: State | None = None
        self._detection: BoxDetection | None = None
        self._exposure: tuple[float, ExpectedBox] | None = None
        self._pending: tuple[float, BoxDetection] | None = None
        self._on_target: Callable[[JointState, MotionTarget], None] | None = None

    def run(
        self,
        on_tick: Callable[[Tick], None] | None = None,
        on_target: Callable[[JointState, MotionTarget], None] | None = None,
    ) -> PalletRun:
        """Run to the end.

        Args:
            on_tick: is called in every cycle.
            on_target: sees what the arm is asked for, and the state in which it is.
        """
        self._on_target = on_target
        with open_box_finder(self._cell, self._config.sight, self.simulator, self._rng) as finder:
            while not self.palletizer.machine.is_over:
                self._turn(finder, on_tick)
        for _ in range(round(self._config.settle / self._config.period)):
            self._advance()
        return self._log.run(self._seed, self.palletizer.report())

    def _turn(self, finder: BoxFinder, on_tick: Callable[[Tick], None] | None) -> None:
        """One cycle: observe, step the machine, carry out its commands, and advance motion and physics."""
        simulator, machine = self.simulator, self.palletizer.machine
        if self._pending is not None and simulator.time >= self._pending[0]:
            self._detection, self._pending = self._pending[1], None
        seen = PalletObservation(
            simulator.time, self.motion.status(), simulator.gripper.state, self._spawned, self._detection,
            self._answered(),
        )  # fmt: skip
        before = self._target
        for command in self.palletizer.step(seen):
            self._apply(command)
        self._expose(finder)
        if self.palletizer.leg_end is None and before is not None:
            self._log.note_way_point(before, seen.motion)
        self._target = self.palletizer.leg_end
        if on_tick is not None:
            on_tick(Tick(seen.time, machine.state, machine.visits[-1].box, seen.motion))
        self._advance()

    def _apply(self, command: Command) -> None:
        match command:
            case SpawnBox(name, dims, mass):
                self.simulator.spawn(BoxBody(name, dims, mass))
                self._spawned = name
            case DiscardBox(name):
                if any(box.name == name for box in self.simulator.boxes):
                    self.simulator.remove(name)
            case TakePicture() | ScanPlace():
                self._look(command)
            case PursueTarget(target):
                self._pursue(target)
            case StopArm():
                self.motion.stop()
            case CloseGripper():
                self.simulator.gripper.close()
            case OpenGripper():
                self.simulator.gripper.open()

    def _pursue(self, target: MotionTarget) -> None:
        if self._on_target is not None:
            self._on_target(self.motion.commanded, target)
        if self.motion.command(target).is_accepted:
            self._log.note_target(self.motion.plan.X_WT)

    def _look(self, command: TakePicture | ScanPlace) -> None:
        """Ask for a picture, or scan a place; the result is known a little later."""
        if isinstance(command, ScanPlace):
            self._scans[command.place] = self._scanner.scan(command.place, self.simulator.still())
        elif not self.camera_is_silent:
            time = self._config.sight.camera.exposure_time(self.simulator.time)
            self._exposure = time, command.expected

    def _expose(self, finder: BoxFinder) -> None:
        """Take the picture that was asked for, once its time has come; the result is known a little later."""
        if self._exposure is not None and self.simulator.time >= self._exposure[0]:
            detection = finder.detect(self._exposure[1], self.simulator)
            self._pending = self.simulator.time + self._latency(), detection
            self._exposure = None

    def _answered(self) -> tuple[PlaceScan, ...]:
        """The scans whose results have come by now."""
        latest = self.simulator.time - self._config.scanner.latency
        return tuple(scan for scan in self._scans.values() if scan.time <= latest)

    def _latency(self) -> float:
        """Time from a picture to its detection [s]."""
        camera = self._cell.imperfections.camera
        return self._config.sight.latency if camera is None else float(self._rng.uniform(*camera.latency))

    def _advance(self) -> None:
        self._log.note(self._arm.q_des, self.motion.mode)
        seen = self._sensor.observe(self.simulator.time)
        if seen is not None:
            self.motion.observe(seen.obstacles, seen.time)
        self._arm.advance()
