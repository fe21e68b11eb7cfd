"""The action /calibrate_cell: which goals are taken, and how they are pursued and reported."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial

from pack_interfaces.action import CalibrateCell
from rclpy.task import Future

from pack_core.errors import ConfigError, PackError
from pack_core.motion import topics
from pack_core.palletizing.calibration import KnownCell
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.robots.gears import GearCompensation
from pack_core.ros.goal_node import GoalNode
from pallet_fsm.calibration.conclusion import CalibrationRun, calibratable, conclude
from pallet_fsm.calibration.job import RigJob
from pallet_fsm.calibration.procedure import agenda_of, measure
from pallet_fsm.calibration.progress import Agenda, CalibrationState
from pallet_fsm.calibration.quick_check import Checked, check, check_agenda
from pallet_fsm.calibration.rig import CalibrationRig
from pallet_fsm.calibration.steps import A, CalibrationFailed
from pallet_fsm.ports import Command
from pallet_fsm.ros.calibration_goal import CalibrationGoal
from pallet_fsm.ros.calibration_messages import to_calibrated, to_checked
from pallet_fsm.ros.observer import Observer

PERIOD = 1.0 / topics.JOINT_RATE
"""Between two joint states [s]."""


class CalibrationAction:
    """Calibrates the cell, and tests calibrations.

    Args:
        node: that takes the goals.
        observer: hears motion and gripper.
        apply: carries out a command.
    """

    def __init__(self, node: GoalNode, observer: Observer, apply: Callable[[Command], None]) -> None:
        self._node, self._observer, self._apply = node, observer, apply
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
        return to_checked(Checked(await self._run(job, agenda), job.seconds))

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
        return to_calibrated(await self._in_a_thread(work))

    async def _run(self, job: RigJob[A], agenda: Agenda) -> A:
        """The outcome of a job; raises PackError if it has none."""
        self._goal = CalibrationGoal(self._node, self._observer, self._apply, job, agenda)
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
