"""What a calibration may use of the cell: moves, the driver's joints and torques, gripper and camera.

Nothing else of the cell is reached from here on: where things truly are stays unknown.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.moves import Line, Move, Path, PoseMove
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.arm_kinematics import arm_kinematics
from pack_core.palletizing.box_body import BoxBody
from pack_core.palletizing.box_detection import ExpectedBox
from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Pose
from pallet_fsm import ports
from pallet_fsm.calibration.observation import CalibrationObservation
from pallet_fsm.calibration.steps import CalibrationFailed, Steps, TouchInterrupted

LONGEST_MOVE = 60.0
"""A move that takes longer has failed [s]."""
PATIENCE = 10.0
"""Longest wait for the operator, for the answer to a picture, and for a touch to begin [s]."""
LOOSE = ReachTolerance(position=0.02, orientation_deg=2.0)
"""Way-points need not be reached exactly: what counts is what the joints report there."""


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
        self._id: int | None = None

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
        self._command(Path((Line(X_WT, speed, 0.1),)), is_checked=False)
        asked = self.seen.time
        while self._status() is None:  # the arm stands while its move is planned
            if self.seen.time > asked + PATIENCE:
                raise CalibrationFailed("the arm does not begin to move")
            yield
        samples = [self.seen.joints()]
        while not until(samples[-1]):
            status = self._status()
            if status is not None and status.state in (MotionState.REACHED, MotionState.STUCK):
                raise CalibrationFailed(
                    f"nothing was touched on the way to {np.round(X_WT.p, 3).tolist()} m; is it there?"
                )
            if status is not None and status.state is MotionState.HELD:
                raise TouchInterrupted(status.reason)
            self._check(status)
            yield
            samples.append(self.seen.joints())
        self.commands.append(ports.StopArm())
        yield from self.wait(0.15)
        return samples

    def wait(self, time: float) -> Steps[None]:
        """Let time pass [s], in whole periods."""
        end = self.seen.time + (round(time / self.period) - 0.5) * self.period
        while self.seen.time < end:
            yield

    def bring(self, body: BoxBody, X_NB: Pose) -> Steps[None]:
        """The operator lays something on the picking table; raises CalibrationFailed if it does not come."""
        self.commands.append(ports.LayOnTable(body, X_NB))
        asked = last = self.seen.time
        yield
        while self.seen.laid != body.name:
            if self.seen.time > asked + PATIENCE:
                raise CalibrationFailed(f"nobody has laid the {body.name} on the picking table")
            last = self.seen.time
            yield
        yield from self.wait(0.5 - (self.seen.time - last))

    def take_away(self, name: str) -> None:
        """The operator takes something out of the cell."""
        self.commands.append(ports.DiscardBox(name))
        self.carried = None

    def grip(self, carried: CarriedBox) -> Steps[None]:
        """Close the gripper; raises CalibrationFailed when it holds nothing."""
        self.commands.append(ports.CloseGripper())
        end = self.seen.time + 2.0
        while not self.seen.grip.is_closed:
            if self.seen.time > end:
                raise CalibrationFailed(f"the gripper holds nothing: {self.seen.grip.reason}")
            yield
        yield from self.wait(0.3)
        self.carried = carried

    def release(self) -> Steps[None]:
        """Open the gripper; raises CalibrationFailed when it stays closed."""
        self.commands.append(ports.OpenGripper())
        yield from self.wait(0.3)
        if self.seen.grip.is_closed:
            raise CalibrationFailed("the gripper does not open")
        self.carried = None

    def look(self, body: BoxBody) -> Steps[JointSample]:
        """Take a picture for something that is to be found in it; returns the joints at that moment.

        The answer is then `seen.sighting` for the board and `seen.detection` for anything else.

        Raises:
            CalibrationFailed: no answer comes.
        """
        yield from self.wait(0.4)
        sample, asked = self.seen.joints(), self.seen.time
        self.commands.append(ports.TakePicture(ExpectedBox(body.name, body.size, asked)))
        while not self._is_answered(body.name, asked):
            if self.seen.time > asked + PATIENCE:
                raise CalibrationFailed("the camera does not answer")
            yield
        return sample

    def _is_answered(self, name: str, asked: float) -> bool:
        sighting, detection = self.seen.sighting, self.seen.detection
        if sighting is not None and sighting.time >= asked:
            return True
        return detection is not None and detection.box_id == name and detection.time >= asked

    def _follow(self, move: Move) -> Steps[None]:
        self._command(move, is_checked=True)
        end = self.seen.time + LONGEST_MOVE
        while (status := self._status()) is None or status.state is not MotionState.REACHED:
            self._check(status)
            if self.seen.time > end:
                raise CalibrationFailed("the arm did not arrive: the move takes too long")
            yield

    def _check(self, status: MotionStatus | None) -> None:
        """Raise CalibrationFailed for a move that was refused or is stuck."""
        if status is not None and status.state is MotionState.REFUSED:
            raise CalibrationFailed(f"the arm cannot go there: {status.reason}")
        if status is not None and status.state is MotionState.STUCK:
            raise CalibrationFailed(f"the arm did not arrive: {status.reason or status.state.value}")

    def _status(self) -> MotionStatus | None:
        """Where the present move stands; None before the motion has taken it up."""
        return self.seen.motion if self.seen.motion.id == self._id else None

    def _command(self, move: Move, *, is_checked: bool) -> None:
        # Numbers go on from those of earlier goals, whose last status may still be the newest.
        self._id = (self.seen.motion.id if self._id is None else self._id) + 1
        target = MotionTarget(
            self._id, move, self.carried, self.obstacles, frozenset(), LOOSE, is_checked=is_checked
        )
        self.commands.append(ports.PursueTarget(target))
