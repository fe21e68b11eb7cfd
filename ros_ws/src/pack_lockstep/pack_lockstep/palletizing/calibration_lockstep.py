"""The calibration of the palletizing cell and its check in one process, without ROS, on simulated time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.palletizing.boxes import BoxDetection, ExpectedBox
from pack_core.palletizing.calibration import CellCalibration
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD, BoardSighting
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.ports import (
    CloseGripper,
    Command,
    DiscardBox,
    LayOnTable,
    OpenGripper,
    PursueTarget,
    StopArm,
    TakePicture,
)
from pack_core.robots.joint_properties import GearCompensation
from pack_core.tasks.steps import A
from pack_lockstep.driven_arm import DrivenArm
from pack_lockstep.palletizing.calibration_log import CalibrationLog
from pack_lockstep.palletizing.stepped_cell import PalletLockstepConfig
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set
from pack_perception.boxes.board_corners import sight_board
from pack_perception.boxes.box_vision import BoxVision
from pack_perception.boxes.table_camera import TableCamera
from pack_sim.palletizing.overhead_camera import PalletCamera
from pack_sim.palletizing.simulator import PalletSimulator
from pallet_calibration.conclusion import CalibrationRun, calibratable, conclude
from pallet_calibration.procedure import agenda_of, measure
from pallet_calibration.progress import Agenda, CalibrationProgress, CalibrationState
from pallet_calibration.quick_check import Checked, check, check_agenda
from pallet_calibration.rig import CalibrationFailed, CalibrationObservation, CalibrationRig, RigJob

OnProgress = Callable[[CalibrationProgress], None]
"""Called with where the work stands."""


def calibrate(
    cell: PalletizingCell, config: PalletLockstepConfig, seed: int, on_progress: OnProgress = lambda _: None,
    log: CalibrationLog | None = None, driver: GearCompensation | None = None,
) -> CalibrationRun:  # fmt: skip
    """Calibrate the cell of a seed.

    Args:
        cell: the cell as its installer left it on paper.
        config: parameters of the run.
        seed: which cell it truly is.
        on_progress: called with where the work stands.
        log: records it for a video.
        driver: what the driver compensates, of an earlier calibration; by default what the preset says.

    Raises:
        CalibrationFailed: something could not be measured, or the residuals say that something is wrong; or
            the cell's preset has nothing to calibrate.
    """
    calibratable(cell)
    rig = CalibrationRig(cell, config.period)
    agenda = agenda_of(rig)
    job = RigJob(rig, lambda rig: measure(rig, agenda))
    lockstep = CalibrationLockstep(cell, cell, config, seed, driver, log)
    measured = lockstep.run(job, agenda, on_progress)
    fit = CalibrationProgress(CalibrationState.FIT, "", 1, 1, 0.0)
    on_progress(fit)
    if log is not None:
        log.note_progress(fit, lockstep.simulator.time)
    return conclude(cell, measured, job.seconds, driver)


def quick_check(
    cell: PalletizingCell, config: PalletLockstepConfig, seed: int, calibration: CellCalibration,
    on_progress: OnProgress = lambda _: None,
) -> Checked:  # fmt: skip
    """Test a calibration on the cell of a seed; raises CalibrationFailed when the arm or the box is stuck."""
    known = calibration.applied(cell)
    agenda = check_agenda()
    job = RigJob(CalibrationRig(known, config.period), lambda rig: check(rig, agenda))
    lockstep = CalibrationLockstep(cell, known, config, seed, calibration.gears)
    return Checked(lockstep.run(job, agenda, on_progress), job.seconds)


class CalibrationLockstep:
    """Runs one job of a calibration from start to end.

    Args:
        cell: the cell as it is configured.
        known: the cell as box vision knows it.
        config: parameters of the run.
        seed: which cell it truly is.
        assumed: what the driver assumes of the gears; by default what the preset says.
        log: records it for a video.
    """

    def __init__(
        self, cell: PalletizingCell, known: PalletizingCell, config: PalletLockstepConfig, seed: int,
        assumed: GearCompensation | None = None, log: CalibrationLog | None = None,
    ) -> None:  # fmt: skip
        self._known, self._config, self._log = known, config, log
        self.simulator = PalletSimulator(cell, config.simulator, seed, assumed=assumed)
        q = np.array(cell.arm.home)
        self._motion = MotionController(
            load_arm("palletizing"), motion_set(config.motion), self.simulator.time, q
        )
        self._arm = DrivenArm(self._motion, self.simulator, q, config.period, self._refused)
        errors, usual = cell.imperfections.camera, config.sight.latency
        latency = usual if errors is None else float(np.mean(errors.latency))
        self._latency = round(latency / config.period) * config.period
        self._laid = ""
        self._sighting: BoardSighting | None = None
        self._detection: BoxDetection | None = None
        self._pending: tuple[float, BoardSighting | BoxDetection] | None = None

    def run(self, job: RigJob[A], agenda: Agenda, on_progress: OnProgress = lambda _: None) -> A:
        """Run to the end, and return the job's outcome; raises CalibrationFailed."""
        with self.simulator.open_camera(self._config.sight.camera) as camera:
            reported = None
            while not job.is_over:
                self._turn(job, camera)
                progress = agenda.progress(self.simulator.time)
                if (now := (progress.state, progress.number)) != reported:
                    reported = now
                    on_progress(progress)
                    if self._log is not None:
                        self._log.note_progress(progress, self.simulator.time)
        if job.outcome is None:
            raise CalibrationFailed(job.failure)
        return job.outcome

    def _turn(self, job: RigJob[A], camera: PalletCamera) -> None:
        """One cycle: observe, step the job, carry out its commands, and advance motion and physics."""
        commands = job.step(self._observe())
        is_refused = False
        for command in commands:
            is_refused |= not self._apply(command, camera)
        if not (is_refused or job.is_over):  # a refusal is known at once
            self._arm.advance()
            if self._log is not None:
                self._log.note(self.simulator)

    def _observe(self) -> CalibrationObservation:
        simulator = self.simulator
        if self._pending is not None and simulator.time >= self._pending[0]:
            answer, self._pending = self._pending[1], None
            if isinstance(answer, BoardSighting):
                self._sighting = answer
            else:
                self._detection = answer
        return CalibrationObservation(
            simulator.time, self._motion.status(), simulator.gripper.state, detection=self._detection,
            laid=self._laid, joints=simulator.joints, sighting=self._sighting,
        )  # fmt: skip

    def _apply(self, command: Command, camera: PalletCamera) -> bool:
        """Carry a command out; False for a move that is refused."""
        match command:
            case LayOnTable(body, X_NB):
                self.simulator.lay(body, X_NB)
                self._laid = body.name
            case DiscardBox(name):
                self.simulator.remove(name)
            case TakePicture(expected):
                due = self.simulator.time + self._latency - 0.5 * self._config.period
                self._pending = due, self._find(expected, camera)
            case PursueTarget(target):
                return self._motion.command(target).is_accepted
            case StopArm():
                self._motion.stop()
            case CloseGripper():
                self.simulator.gripper.close()
            case OpenGripper():
                self.simulator.gripper.open()
        return True

    def _find(self, expected: ExpectedBox, camera: PalletCamera) -> BoardSighting | BoxDetection:
        """What is found in a picture of this moment."""
        picture, time = camera.picture(self.simulator.snapshot()), self.simulator.time
        if expected.id == CALIBRATION_BOARD.name:
            seen = sight_board(picture, time)
            if self._log is not None:
                self._log.note_sighting(picture, seen)
            return seen
        vision, width = BoxVision(self._config.sight.vision), self._config.sight.camera.width
        seen_by = self._known.overhead_camera.scaled(width)
        return TableCamera(self._known, vision, seen_by).detect(picture, expected, time).detection

    def _refused(self, reason: str) -> None:
        raise CalibrationFailed(reason)
