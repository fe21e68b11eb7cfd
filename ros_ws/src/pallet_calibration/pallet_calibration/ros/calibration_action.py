"""The action /calibrate_cell: which goals are taken, how they are pursued, and what became of them."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

from pack_interfaces.action import CalibrateCell
from pack_interfaces.msg import BoardSighting as BoardSightingMsg
from rclpy.task import Future
from sensor_msgs.msg import JointState

from pack_core.errors import ConfigError, PackError
from pack_core.joints import JointSample
from pack_core.motion import topics
from pack_core.palletizing.calibration import KnownCell
from pack_core.palletizing.calibration_board import BoardSighting
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.ports import Command, PalletObservation
from pack_core.robots.joint_properties import GearCompensation
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.palletizing import from_sighting
from pack_core.ros.stream import Stream
from pack_core.tasks.steps import A
from pallet_calibration.conclusion import CalibrationRun, calibratable, conclude
from pallet_calibration.procedure import agenda_of, measure
from pallet_calibration.progress import Agenda, CalibrationState
from pallet_calibration.quick_check import Checked, check, check_agenda
from pallet_calibration.rig import CalibrationFailed, CalibrationObservation, CalibrationRig, RigJob

PERIOD = 1.0 / topics.JOINT_RATE
"""Between two joint states [s]."""
FEEDBACK_PERIOD = 1.0
"""Between two messages to the client while nothing else changes [s]."""
TAKE_PERIOD = 0.01
"""Wall clock between two checks of what joint states have come [s]; the arm moves up to 0.1 mm meanwhile."""
DEPTH = 1000
"""Joint states that may wait: a touch needs them all, also where the machine is busy for a moment."""
Observe = Callable[[], PalletObservation | None]
"""What is known of the cell now; None before the first messages of motion and gripper."""
Apply = Callable[[Command], None]
"""Carries out a command."""


class CalibrationAction:
    """Calibrates the cell, and tests calibrations.

    Args:
        node: that takes the goals.
        observe: what is known of the cell now.
        apply: carries out a command.
    """

    def __init__(self, node: GoalNode, observe: Observe, apply: Apply) -> None:
        self._node, self._observe, self._apply = node, observe, apply
        self._goal: CalibrationGoal | None = None

    def halt(self, reason: str) -> None:
        """End the goal in progress, if there is one, the arm at rest."""
        if self._goal is not None:
            self._goal.halt(reason)

    def forget(self) -> None:
        """Step the goal in progress no more."""
        if self._goal is not None:
            self._goal.close()
            self._goal = None

    async def pursue(self, request: CalibrateCell.Goal, known: KnownCell) -> CalibrateCell.Result:
        """Calibrate the cell, or test its calibration.

        Raises:
            PackError: it cannot be done in this cell, was not finished, or is not to be trusted.
        """
        if request.check:
            if known.calibration is None:
                raise ConfigError("the cell was started without a calibration: there is nothing to test")
            return await self._check(known.cell)
        calibratable(known.cell)
        driver = None if known.calibration is None else known.calibration.gears
        # From the cell on paper, whatever an earlier calibration says: its errors must not come along.
        return await self._calibrate(palletizing_cell(known.cell.preset), driver)

    async def _check(self, cell: PalletizingCell) -> CalibrateCell.Result:
        agenda = check_agenda()
        job = RigJob(CalibrationRig(cell, PERIOD), lambda rig: check(rig, agenda))
        return _to_checked(Checked(await self._run(job, agenda), job.seconds))

    async def _calibrate(
        self, cell: PalletizingCell, driver: GearCompensation | None
    ) -> CalibrateCell.Result:
        rig = CalibrationRig(cell, PERIOD)
        agenda = agenda_of(rig)
        job = RigJob(rig, lambda rig: measure(rig, agenda))
        measured = await self._run(job, agenda)
        fit = CalibrationState.FIT.value
        self._node.publish_feedback(CalibrateCell.Feedback(state=fit, number=1, count=1, elapsed=job.seconds))
        work = partial(conclude, cell, measured, job.seconds, driver)
        return _to_calibrated(await self._in_a_thread(work))

    async def _run(self, job: RigJob[A], agenda: Agenda) -> A:
        """The outcome of a job; raises PackError if it has none."""
        self._goal = CalibrationGoal(self._node, self._observe, self._apply, job, agenda)
        try:
            await self._node.until_goal_ends()
        finally:
            self.forget()
        if job.outcome is None:
            raise CalibrationFailed(job.failure)
        return job.outcome

    async def _in_a_thread(self, conclude: Callable[[], CalibrationRun]) -> CalibrationRun:
        """Estimate in a thread of its own, which takes some seconds; raises CalibrationFailed."""
        done = Future(executor=self._node.executor)

        def work() -> None:
            try:
                done.set_result(conclude())
            except Exception as error:
                done.set_exception(error)

        threading.Thread(target=work, name="calibration", daemon=True).start()
        await done
        if self._node.is_cancel_requested:
            raise PackError("canceled on request")
        return done.result()


class CalibrationGoal:
    """Steps a job with every joint state, and tells the client where it stands.

    It listens to joint states and sightings for as long as it runs only, and takes joint states by hand: 250
    callbacks a second are more than a busy machine gets done.

    Args:
        node: that has the goal.
        observe: what is known of the cell now.
        apply: carries out a command.
        job: what is to be done.
        agenda: where that stands.
    """

    def __init__(
        self, node: GoalNode, observe: Observe, apply: Apply, job: RigJob[Any], agenda: Agenda
    ) -> None:
        self._node, self._observe, self._apply = node, observe, apply
        self._job, self._agenda = job, agenda
        self._sighting: BoardSighting | None = None
        self._published: tuple[object, ...] = ()
        self._joints = Stream(node, contracts.JOINT_STATES, depth=DEPTH)
        self._sightings = node.listen(contracts.BOARD_SIGHTING, self._on_sighting)
        self._timer = node.create_timer(TAKE_PERIOD, self._take, clock=node.wall)

    def close(self) -> None:
        """Listen no longer."""
        self._node.destroy_timer(self._timer)
        self._node.destroy_subscription(self._sightings)
        self._joints.close()

    def halt(self, reason: str) -> None:
        """End the job for a reason, the arm at rest; does nothing after its end."""
        self._carry_out(self._job.halt(reason))

    def _on_sighting(self, message: BoardSightingMsg) -> None:
        self._sighting = from_sighting(message)

    def _take(self) -> None:
        for message in self._joints.take_all():
            self._node.guard(contracts.JOINT_STATES, self._on_joints, message)

    def _on_joints(self, message: JointState) -> None:
        sample, seen = from_joint_state(message, JOINTS), self._observe()
        if seen is None or self._job.is_over:
            return
        if self._node.is_cancel_requested:
            self.halt("canceled on request")
            return
        observation = CalibrationObservation(
            sample.time, seen.motion, seen.grip, detection=seen.detection, laid=seen.laid,
            joints=lambda: sample, sighting=self._sighting,
        )  # fmt: skip
        self._carry_out(self._job.step(observation))
        self._publish_progress(sample)

    def _carry_out(self, commands: tuple[Command, ...]) -> None:
        for command in commands:
            self._apply(command)
        if self._job.is_over:
            self._node.end_goal()

    def _publish_progress(self, sample: JointSample) -> None:
        now = self._agenda.progress(sample.time)
        stands = now.state, now.number, self._job.seconds // FEEDBACK_PERIOD
        if stands == self._published:
            return
        if stands[:2] != self._published[:2]:
            self._node.get_logger().info(now.words)
        self._published = stands
        feedback = CalibrateCell.Feedback(
            state=now.state.value, what=now.what, number=now.number, count=now.count,
            remaining=now.remaining, elapsed=self._job.seconds,
        )  # fmt: skip
        self._node.publish_feedback(feedback)


def _to_calibrated(run: CalibrationRun) -> CalibrateCell.Result:
    """The result of a calibration that is to be trusted."""
    calibration, found = run.calibration, run.found
    report = {
        "views": [
            {"pixels": view.pixels.tolist(), "off": off.tolist()}
            for view, off in zip(run.measured.views, found.views, strict=True)
        ],
        "touches": [
            {"name": contact.name, "off": float(off), "sigma": float(sigma)}
            for contact, off, sigma in zip(run.measured.contacts, found.contacts, found.expected, strict=True)
        ],
    }
    return CalibrateCell.Result(
        success=True, calibration=calibration.to_yaml(), predicted_mean=calibration.predicted.mean,
        predicted_p95=calibration.predicted.p95, execution_time=calibration.simulated_s,
        report=json.dumps(report),
    )  # fmt: skip


def _to_checked(checked: Checked) -> CalibrateCell.Result:
    """The result of a test."""
    rows = [
        {"name": line.name, "off_mm": line.off_mm, "allowed_mm": line.allowed_mm} for line in checked.lines
    ]
    message = "" if checked.holds else f"{checked.worst}: calibrate again"
    return CalibrateCell.Result(
        success=checked.holds, message=message, execution_time=checked.seconds,
        report=json.dumps({"lines": rows}),
    )  # fmt: skip
