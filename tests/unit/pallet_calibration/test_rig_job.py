"""Work with the cell as a job, in a cell that does at once what it is told, or says why not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.grip import GripState
from pack_core.palletizing.ports import Command, LayOnTable, PursueTarget, StopArm, TakePicture
from pack_core.rotations import Pose
from pack_core.tasks.steps import Steps
from pallet_calibration.procedure import agenda_of
from pallet_calibration.progress import CalibrationState
from pallet_calibration.rig import PATIENCE, CalibrationObservation, CalibrationRig, RigJob
from pallet_calibration.touch import DOWN, TRIES, rotated_down, touch

PERIOD = 0.004
REAL = palletizing_cell("real")
X_WT = Pose(np.array([-2.3, 2.4, 1.3]), rotated_down(0.0))
THING = BoxBody("thing", (0.4, 0.3, 0.2), 5.0)
LAST = 7
"""Number of the last target of an earlier goal, which was reached."""


class PromptCell:
    """Has done in the next period what it was told; `answer` is what the motion says to each target."""

    def __init__(
        self, answer: MotionState = MotionState.REACHED, reason: str = "",
        in_a_press: MotionState | None = None,
    ) -> None:  # fmt: skip
        self.time, self.commands = 1.0, list[Command]()
        self._answer, self._reason, self._in_a_press = answer, reason, in_a_press or answer
        self._id, self._state, self.laid = LAST, MotionState.REACHED, ""

    def run(self, job: RigJob[None], longest: float = 100.0) -> None:
        end = self.time + longest
        while not job.is_over and self.time < end:
            for command in job.step(self.observe()):
                self.commands.append(command)
                match command:
                    case PursueTarget(target):
                        self._id = target.id
                        self._state = self._in_a_press if is_press(command) else self._answer
                    case LayOnTable(body, _):
                        self.laid = body.name
            self.time += PERIOD

    def observe(self) -> CalibrationObservation:
        q = arm_kinematics().home
        status = MotionStatus(
            self.time, self._id, self._state, 0, "", 0.0, 0.0, 0.0, 0.0, 0, self._reason, X_WT
        )
        sample = JointSample(self.time, q, np.zeros(6), np.zeros(6))
        return CalibrationObservation(self.time, status, GripState(), laid=self.laid, joints=lambda: sample)


def is_press(command: Command) -> bool:
    """Whether a command is a move into something."""
    return isinstance(command, PursueTarget) and not command.target.is_checked


def job_of(work: str) -> RigJob[None]:
    def steps(rig: CalibrationRig) -> Steps[None]:
        match work:
            case "go":
                yield from rig.go(X_WT)
            case "wait":
                yield from rig.pause(0.15)
            case "bring":
                yield from rig.bring(THING, Pose(np.zeros(3)))
            case "look":
                yield from rig.take_picture(THING)
            case "touch":
                yield from touch(rig, X_WT, DOWN, 0.03, ("picking_table", 2, 0.8), np.zeros(3))
            case "press":
                yield from rig.press(X_WT, 0.01, lambda _: False)

    return RigJob(CalibrationRig(REAL, PERIOD), steps)


def test_targets_are_numbered_on_from_an_earlier_goal_whose_status_counts_for_nothing() -> None:
    cell, job = PromptCell(MotionState.MOVING), job_of("go")
    cell.run(job, 1.0)
    (command,) = cell.commands
    assert isinstance(command, PursueTarget)
    assert command.target.id == LAST + 1
    assert not job.is_over


def test_waiting_takes_whole_periods() -> None:
    cell, job = PromptCell(), job_of("wait")
    cell.run(job)
    assert job.seconds == pytest.approx(38 * PERIOD)


def test_what_the_operator_laid_is_used_half_a_second_later() -> None:
    cell, job = PromptCell(), job_of("bring")
    cell.run(job)
    assert not job.failure
    assert job.seconds == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("work", "cell", "reason"),
    [
        ("go", PromptCell(MotionState.REFUSED, "out of reach"), "the arm cannot go there: out of reach"),
        ("go", PromptCell(MotionState.STUCK, "no way on"), "the arm did not arrive: no way on"),
        ("go", PromptCell(MotionState.MOVING), "the move takes too long"),
        ("press", PromptCell(), "nothing was touched on the way"),
        ("look", PromptCell(), "the camera does not answer"),
    ],
    ids=["refused", "stuck", "endless", "nothing there", "no camera"],
)
def test_a_job_that_cannot_go_on_says_why_and_has_the_arm_stopped(
    work: str, cell: PromptCell, reason: str
) -> None:
    job = job_of(work)
    cell.run(job)
    assert reason in job.failure
    assert job.outcome is None
    assert isinstance(cell.commands[-1], StopArm)


def test_a_touch_in_which_the_driver_holds_the_arm_is_tried_again_and_then_given_up() -> None:
    cell, job = PromptCell(reason="no joint states for 0.1 s", in_a_press=MotionState.HELD), job_of("touch")
    cell.run(job)
    assert "picking_table: the touch was interrupted 3 times: no joint states" in job.failure
    assert sum(is_press(command) for command in cell.commands) == TRIES


def test_a_picture_is_asked_for_once_and_waited_for() -> None:
    cell, job = PromptCell(), job_of("look")
    cell.run(job, PATIENCE - 1.0)
    assert [type(command) for command in cell.commands] == [TakePicture]


def test_a_halted_job_stops_the_arm_once_and_does_nothing_more() -> None:
    cell, job = PromptCell(MotionState.MOVING), job_of("go")
    cell.run(job, 0.1)
    assert job.halt("a button") == (StopArm(),)
    assert (job.is_over, job.failure) == (True, "a button")
    assert job.halt("another") == ()
    assert job.step(cell.observe()) == ()
    assert job.failure == "a button"


def test_the_agenda_counts_touches_and_tells_less_and_less_time() -> None:
    agenda = agenda_of(CalibrationRig(REAL, PERIOD))
    before = agenda.progress(0.0)
    assert (before.state, before.number, before.count) == (CalibrationState.TOUCH, 1, 22)
    for number in range(22):
        agenda.begin(CalibrationState.TOUCH, "picking table", 10.0 * number)
    late = agenda.progress(215.0)
    assert late.number == 22
    assert late.remaining < before.remaining
    agenda.begin(CalibrationState.TAKE_BOARD, "", 220.0)
    shown = agenda.progress(221.0)
    assert (shown.state, shown.number, shown.count) == (CalibrationState.TAKE_BOARD, 1, 1)
    assert "take the board; about" in shown.words
    assert shown.remaining < late.remaining


@pytest.mark.parametrize(("planning", "reason"), [(0.3, ""), (2.0 * PATIENCE, "does not begin to move")])
def test_a_touch_begins_when_the_motion_has_planned_it(planning: float, reason: str) -> None:
    samples: list[JointSample] = []

    def press(rig: CalibrationRig) -> Steps[None]:
        samples.extend((yield from rig.press(X_WT, 0.001, lambda sample: sample.time > 1.5)))

    class SlowPlanner(PromptCell):
        def observe(self) -> CalibrationObservation:
            seen = super().observe()
            is_planned = self.time >= 1.0 + planning
            return seen if is_planned else replace(seen, motion=replace(seen.motion, id=LAST))

    job = RigJob(CalibrationRig(REAL, PERIOD), press)
    SlowPlanner(MotionState.MOVING).run(job)
    assert reason in job.failure
    assert bool(samples) is not bool(reason)
    assert all(sample.time >= 1.0 + planning for sample in samples)
