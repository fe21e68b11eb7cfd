"""What a calibration may use of the cell: moves, the driver's joints and torques, gripper and camera.

Nothing else of the cell is reached from here on: where things truly are stays unknown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pack_core.errors import PackError
from pack_core.joints import JointSample
from pack_core.motion.moves import Line, Move, Path, PoseMove
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing import ports
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.boxes import BoxBody, ExpectedBox
from pack_core.palletizing.calibration_board import BoardSighting
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Pose
from pack_core.tasks.move import MoveFollower, follow
from pack_core.tasks.steps import A, Steps, TaskRun, wait

LONGEST_MOVE = 60.0
"""A move that takes longer has failed [s]."""
PATIENCE = 10.0
"""Longest wait for the operator, for the answer to a picture, and for a touch to begin [s]."""
GRIP_PATIENCE = 2.0
"""Longest wait for the gripper to hold something [s]."""
AT_REST = 0.5
"""Time after which something that the operator has laid down is at rest [s]."""
LOOSE = ReachTolerance(position=0.02, orientation_deg=2.0)
"""Way-points need not be reached exactly: what counts is what the joints report there."""


class CalibrationFailed(PackError):
    """The calibration cannot be finished; the text says why."""


class TouchInterrupted(CalibrationFailed):
    """The driver held the arm in the middle of a touch: what was felt until then says nothing."""


@dataclass(frozen=True, kw_only=True)
class CalibrationObservation(ports.PalletObservation):
    """What is known now; its time is that of the joints.

    Attributes:
        joints: reads what the driver reports now; its torques have noise.
        sighting: newest sighting of the calibration board; None before the first.
    """

    joints: Callable[[], JointSample]
    sighting: BoardSighting | None = None


class CalibrationRig:
    """The cell as an operator of a calibration has it.

    Args:
        known: the cell as it is known.
        period: time between two samples of the joints [s].

    Attributes:
        seen: the newest observation.
        commands: what the cell shall do now; whoever steps the calibration takes them.
        obstacles: what moves keep clear of.
        carried: what the gripper holds.
    """

    seen: CalibrationObservation

    def __init__(self, known: PalletizingCell, period: float) -> None:
        self.known, self.period = known, period
        self.arm = arm_kinematics()
        self.commands: list[ports.Command] = []
        self.obstacles: tuple[Obstacle, ...] = ()
        self.carried: CarriedBox | None = None
        self._follower = MoveFollower(LONGEST_MOVE, LONGEST_MOVE)

    def tool(self) -> Pose:
        """X_WT by the reported joints."""
        return self.arm.chain.forward(self.seen.joints().q)

    def go(self, X_WT: Pose) -> Steps[None]:
        """Move to a pose of the tool, wherever the way is clear.

        Raises:
            CalibrationFailed: it is out of reach, not clear, or was not reached.
        """
        yield from self._follow(Path((PoseMove(X_WT, speed=1.0),)))

    def line(self, X_WT: Pose, speed: float = 0.25) -> Steps[None]:
        """Move straight to a pose of the tool; raises CalibrationFailed."""
        yield from self._follow(Path((Line(X_WT, speed, 0.5),)))

    def press(
        self, X_WT: Pose, speed: float, until: Callable[[JointSample], bool]
    ) -> Steps[list[JointSample]]:
        """Move straight and slowly towards a pose, and stop when `until` says so.

        Returns:
            All samples from the moment on at which the motion took it up, one a period.

        Raises:
            CalibrationFailed: the pose was reached, so nothing was there.
            TouchInterrupted: the driver held the arm on the way.
        """
        self._send(Path((Line(X_WT, speed, 0.1),)), is_checked=False)
        # The arm stands while its move is planned.
        if not (yield from wait(lambda: self._status() is not None, PATIENCE, self._time)):
            raise CalibrationFailed("the arm does not begin to move")
        samples = [self.seen.joints()]
        while not until(samples[-1]):
            self._check_press(self._status(), X_WT)
            yield
            samples.append(self.seen.joints())
        self.commands.append(ports.StopArm())
        yield from self.pause(0.15)
        return samples

    def pause(self, time: float) -> Steps[None]:
        """Let time pass [s], in whole periods."""
        end = self.seen.time + (round(time / self.period) - 0.5) * self.period
        while self.seen.time < end:
            yield

    def bring(self, body: BoxBody, X_NB: Pose) -> Steps[None]:
        """The operator lays something on the picking table; raises CalibrationFailed if it does not come."""
        self.commands.append(ports.LayOnTable(body, X_NB))
        yield
        if not (yield from wait(lambda: self.seen.laid == body.name, PATIENCE, self._time)):
            raise CalibrationFailed(f"nobody has laid the {body.name} on the picking table")
        yield from self.pause(AT_REST - self.period)  # since the last look at which it was not there

    def take_away(self, name: str) -> None:
        """The operator takes something out of the cell."""
        self.commands.append(ports.DiscardBox(name))
        self.carried = None

    def grip(self, carried: CarriedBox) -> Steps[None]:
        """Close the gripper; raises CalibrationFailed when it holds nothing."""
        self.commands.append(ports.CloseGripper())
        if not (yield from wait(lambda: self.seen.grip.is_closed, GRIP_PATIENCE, self._time)):
            raise CalibrationFailed(f"the gripper holds nothing: {self.seen.grip.reason}")
        yield from self.pause(0.3)
        self.carried = carried

    def release(self) -> Steps[None]:
        """Open the gripper; raises CalibrationFailed when it stays closed."""
        self.commands.append(ports.OpenGripper())
        yield from self.pause(0.3)
        if self.seen.grip.is_closed:
            raise CalibrationFailed("the gripper does not open")
        self.carried = None

    def take_picture(self, body: BoxBody) -> Steps[JointSample]:
        """Take a picture for something that is to be found in it; returns the joints at that moment.

        The answer is then `seen.sighting` for the board and `seen.detection` for anything else.

        Raises:
            CalibrationFailed: no answer comes.
        """
        yield from self.pause(0.4)
        sample, asked = self.seen.joints(), self.seen.time
        self.commands.append(ports.TakePicture(ExpectedBox(body.name, body.size, asked)))
        if not (yield from wait(lambda: self._is_answered(body.name, asked), PATIENCE, self._time)):
            raise CalibrationFailed("the camera does not answer")
        return sample

    def _time(self) -> float:
        return self.seen.time

    def _is_answered(self, name: str, asked: float) -> bool:
        sighting, detection = self.seen.sighting, self.seen.detection
        if sighting is not None and sighting.time >= asked:
            return True
        return detection is not None and detection.box_id == name and detection.time >= asked

    def _follow(self, move: Move) -> Steps[None]:
        self._send(move, is_checked=True)
        end = yield from follow(self._follower, lambda: self.seen.motion, self._time)
        if end.state is MotionState.REFUSED:
            raise CalibrationFailed(f"the arm cannot go there: {end.reason}")
        if end.state is MotionState.STUCK:
            raise CalibrationFailed(f"the arm did not arrive: {end.reason or end.state.value}")

    def _check_press(self, status: MotionStatus | None, X_WT: Pose) -> None:
        """Raise CalibrationFailed where a press towards X_WT meets nothing or cannot go on."""
        if status is None:
            return
        if status.state in (MotionState.REACHED, MotionState.STUCK):
            p = np.round(X_WT.p, 3).tolist()
            raise CalibrationFailed(f"nothing was touched on the way to {p} m; is it there?")
        if status.state is MotionState.HELD:
            raise TouchInterrupted(status.reason)
        if status.state is MotionState.REFUSED:
            raise CalibrationFailed(f"the arm cannot go there: {status.reason}")

    def _status(self) -> MotionStatus | None:
        """Where the present move stands; None before the motion has taken it up."""
        return self.seen.motion if self.seen.motion.id == self._follower.number else None

    def _send(self, move: Move, *, is_checked: bool) -> None:
        number = self._follower.begin(self.seen.motion, self.seen.time)
        target = MotionTarget(
            number, move, self.carried, self.obstacles, frozenset(), LOOSE, is_checked=is_checked
        )
        self.commands.append(ports.PursueTarget(target))


class RigJob(TaskRun[A]):
    """Does one piece of work with the cell, step by step; it has no clock and calls nothing outside.

    Args:
        rig: the cell.
        work: what is to be done with it.

    Attributes:
        seconds: time since the first step [s].
    """

    def __init__(self, rig: CalibrationRig, work: Callable[[CalibrationRig], Steps[A]]) -> None:
        super().__init__(work(rig))
        self._rig = rig
        self._begin: float | None = None
        self.seconds = 0.0

    def step(self, seen: CalibrationObservation) -> tuple[ports.Command, ...]:
        """Go on with the newest observation, and return what the cell shall do now."""
        if self.is_over:
            return ()
        self._rig.seen, self._rig.commands = seen, []
        if self._begin is None:
            self._begin = seen.time
        self.seconds = seen.time - self._begin
        self.go_on()
        return (ports.StopArm(),) if self.failure else tuple(self._rig.commands)

    def halt(self, reason: str) -> tuple[ports.Command, ...]:
        """End the work for a reason, the arm at rest; what the gripper holds it keeps."""
        if self.is_over:
            return ()
        self.fail(reason)
        return (ports.StopArm(),)
