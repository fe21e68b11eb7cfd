"""One calibration, or one test of one, from the first move to the last."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pack_interfaces.action import CalibrateCell
from pack_interfaces.msg import BoardSighting as BoardSightingMsg
from sensor_msgs.msg import JointState

from pack_core.joints import JointSample
from pack_core.palletizing.board_sighting import BoardSighting
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.palletizing import from_sighting
from pack_core.ros.stream import Stream
from pallet_fsm.calibration.job import RigJob
from pallet_fsm.calibration.observation import CalibrationObservation
from pallet_fsm.calibration.progress import Agenda
from pallet_fsm.ports import Command
from pallet_fsm.ros.observer import Observer

FEEDBACK_PERIOD = 1.0
"""Between two messages to the client while nothing else changes [s]."""
TAKE_PERIOD = 0.01
"""Wall clock between two looks at what joint states have come [s]; the arm moves up to 0.1 mm meanwhile."""
DEPTH = 1000
"""Joint states that may wait: a touch needs them all, also where the machine is busy for a moment."""


class CalibrationGoal:
    """Steps a job with every joint state, and tells the client where it stands.

    It listens to joint states and sightings for as long as it runs only, and takes joint states by hand: 250
    callbacks a second are more than a busy machine gets done.

    Args:
        node: that has the goal.
        observer: hears motion and gripper.
        apply: carries out a command.
        job: what is to be done.
        agenda: where that stands.
    """

    def __init__(
        self, node: GoalNode, observer: Observer, apply: Callable[[Command], None], job: RigJob[Any],
        agenda: Agenda,
    ) -> None:  # fmt: skip
        self._node, self._observer, self._apply = node, observer, apply
        self._job, self._agenda = job, agenda
        self._sighting: BoardSighting | None = None
        self._told: tuple[object, ...] = ()
        observer.laid = ""  # of an earlier goal
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
        sample, seen = from_joint_state(message, JOINTS), self._observer.newest
        if seen is None or self._job.is_over:
            return
        if self._node.is_cancel_requested:
            self.halt("canceled on request")
            return
        observation = CalibrationObservation(
            sample.time, seen.motion, seen.grip, lambda: sample, self._observer.laid, self._sighting,
            seen.detection,
        )  # fmt: skip
        self._carry_out(self._job.step(observation))
        self._tell(sample)

    def _carry_out(self, commands: tuple[Command, ...]) -> None:
        for command in commands:
            self._apply(command)
        if self._job.is_over:
            self._node.end_goal()

    def _tell(self, sample: JointSample) -> None:
        now = self._agenda.progress(sample.time)
        told = now.state, now.number, self._job.seconds // FEEDBACK_PERIOD
        if told == self._told:
            return
        if told[:2] != self._told[:2]:
            self._node.get_logger().info(now.words)
        self._told = told
        feedback = CalibrateCell.Feedback(
            state=now.state.value, what=now.what, number=now.number, count=now.count,
            remaining=now.remaining, elapsed=self._job.seconds,
        )  # fmt: skip
        self._node.publish_feedback(feedback)
