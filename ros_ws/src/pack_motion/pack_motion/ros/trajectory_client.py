"""Sends trajectories to a driver's joint trajectory controller, and hears what became of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance, JointTrajectoryControllerState
from rclpy.action import ActionClient
from rclpy.task import Future

from pack_core.joints import Setpoints
from pack_core.ros.contracts import motion as contracts
from pack_core.ros.messages.joints import to_trajectory
from pack_core.ros.node import CellNode
from pack_core.ros.stream import Stream
from pack_core.rotations import Array

ACTION = "/follow_joint_trajectory"
"""What the name of the action ends with; before it stands the controller's."""
GOAL_TIME = 1
"""For which a joint may be beyond its tolerance after the end of a trajectory [s of trajectory time]."""
CODES = {
    FollowJointTrajectory.Result.INVALID_GOAL: "INVALID_GOAL",
    FollowJointTrajectory.Result.INVALID_JOINTS: "INVALID_JOINTS",
    FollowJointTrajectory.Result.OLD_HEADER_TIMESTAMP: "OLD_HEADER_TIMESTAMP",
    FollowJointTrajectory.Result.PATH_TOLERANCE_VIOLATED: "PATH_TOLERANCE_VIOLATED",
    FollowJointTrajectory.Result.GOAL_TOLERANCE_VIOLATED: "GOAL_TOLERANCE_VIOLATED",
}


class TrajectoryClient:
    """A client of the action; each goal replaces the one before, of which nobody asks any more.

    Args:
        node: who sends.
        action: name of the action, such as `/scaled_joint_trajectory_controller/follow_joint_trajectory`.
        names: of the joints.
        tolerance: of each joint on the way and at the end `(n,)` [rad].
        on_rejection: is told why the newest trajectory was not taken, by the executor.
        on_abort: is told why the newest trajectory was given up by the driver, by the executor.
    """

    def __init__(
        self, node: CellNode, action: str, names: tuple[str, ...], tolerance: Array,
        on_rejection: Callable[[str], None], on_abort: Callable[[str], None],
    ) -> None:  # fmt: skip
        self._node, self.action, self._names = node, action, names
        self._tolerances = [
            JointTolerance(name=name, position=float(value))
            for name, value in zip(names, tolerance, strict=True)
        ]
        self._on_rejection, self._on_abort = on_rejection, on_abort
        self._client = ActionClient(node, FollowJointTrajectory, node.in_cell(action))
        self._cancel = node.create_client(CancelGoal, f"{action}/_action/cancel_goal")
        state = action.removesuffix(ACTION) + "/controller_state"
        self._state = Stream(node, replace(contracts.CONTROLLER_STATE, name=state))
        self._number = 0

    @property
    def is_there(self) -> bool:
        """Whether somebody takes trajectories."""
        return bool(self._client.server_is_ready())

    def send(self, trajectory: Setpoints) -> None:
        """Send a trajectory, which begins at its stamp; any thread may do so."""
        self._number += 1
        if not self.is_there:
            self._on_rejection(f"nobody takes trajectories at {self.action}: is the driver up?")
            return
        goal = FollowJointTrajectory.Goal(
            trajectory=to_trajectory(trajectory, self._names), path_tolerance=self._tolerances,
            goal_tolerance=self._tolerances, goal_time_tolerance=Duration(sec=GOAL_TIME),
        )  # fmt: skip
        number = self._number
        sent = self._client.send_goal_async(goal)
        sent.add_done_callback(lambda answered: self._on_answer(number, answered))

    def cancel(self) -> None:
        """Have the driver give up all trajectories, whoever sent them, and hold the arm."""
        self._number += 1
        # A request without an id and a stamp is for all goals.
        self._cancel.call_async(CancelGoal.Request())

    def newest_state(self) -> JointTrajectoryControllerState | None:
        """What the controller has said last since the last call, if anything."""
        heard = self._state.take_all()
        return heard[-1] if heard else None

    def close(self) -> None:
        """End the client, before its node ends."""
        self._client.destroy()

    def _on_answer(self, number: int, answered: Future) -> None:
        handle = answered.result()
        if not handle.accepted:
            if number == self._number:
                self._on_rejection(f"{self.action} rejected a trajectory; the driver's log says why")
            return
        handle.get_result_async().add_done_callback(lambda ended: self._on_end(number, ended))

    def _on_end(self, number: int, ended: Future) -> None:
        answer = ended.result()
        if number == self._number and answer.status == GoalStatus.STATUS_ABORTED:
            result = answer.result
            code = CODES.get(result.error_code, str(result.error_code))
            self._on_abort(f"the driver gave a trajectory up: {code} {result.error_string}".rstrip())
