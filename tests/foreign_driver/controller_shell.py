"""The ROS side of the joint trajectory controller: its action, its topic and its state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from threading import Lock

import numpy as np
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance, JointTrajectoryControllerState, SpeedScalingFactor
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from foreign_driver.joint_trajectory_controller import (
    Goal,
    JointTrajectoryController,
    Outcome,
    Rejected,
    Tolerances,
    Waypoint,
)
from pack_core.ros.messages.conversions import from_stamp, to_stamp
from pack_core.rotations import Array

STATE_CYCLES = 4
"""The state is published in every fourth cycle, 250 times a second."""


@dataclass
class Running:
    """A goal in progress, and what its execution waits for."""

    goal: Goal
    ending: Future


class ControllerShell:
    """Offers the controller below a name, as ros2_control does.

    Args:
        node: that offers it.
        name: of the controller.
        joints: their names, in the order of the controller.
        controller: the controller.
        lock: held by whoever calls `update` of the controller.
        refusal: why no trajectory may be followed now; empty where one may.
    """

    def __init__(
        self, node: Node, name: str, joints: tuple[str, ...], controller: JointTrajectoryController,
        lock: Lock, refusal: Callable[[], str],
    ) -> None:  # fmt: skip
        self._node, self._joints, self._controller, self._lock = node, joints, controller, lock
        self._refusal, self._running, self._cycles = refusal, list[Running](), 0
        self.rejections: list[str] = []
        self._state = node.create_publisher(JointTrajectoryControllerState, f"/{name}/controller_state", 10)
        node.create_subscription(JointTrajectory, f"/{name}/joint_trajectory", self._on_topic, 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(SpeedScalingFactor, f"/{name}/speed_scaling_input", self._on_speed, latched)
        self._action = ActionServer(
            node, FollowJointTrajectory, f"/{name}/follow_joint_trajectory", self._execute,
            goal_callback=self._on_goal, cancel_callback=self._on_cancel,
            handle_accepted_callback=self._on_accepted,
        )  # fmt: skip
        self._accepted: dict[bytes, Running] = {}

    def after_cycle(self) -> None:
        """Tell what the cycle has brought, under the lock."""
        for goal in self._controller.ended():
            for running in [running for running in self._running if running.goal is goal]:
                self._running.remove(running)
                running.ending.set_result(None)
        self._cycles += 1
        if self._cycles % STATE_CYCLES == 0:
            self._state.publish(self._state_message())

    def close(self) -> None:
        """Offer the action no longer."""
        self._action.destroy()

    def _on_speed(self, message: SpeedScalingFactor) -> None:
        with self._lock:
            self._controller.speed = min(max(message.factor, 0.0), 1.0)

    def _on_topic(self, message: JointTrajectory) -> None:
        try:
            points = self._points(message)
            with self._lock:
                if why := self._refusal():
                    raise Rejected(why)
                self._controller.take(points, from_stamp(message.header.stamp))
        except Rejected as reason:
            self._node.get_logger().warning(f"trajectory ignored: {reason}")

    def _on_goal(self, request: FollowJointTrajectory.Goal) -> GoalResponse:
        try:
            points = self._points(request.trajectory)
            with self._lock:
                if why := self._refusal():
                    raise Rejected(why)
                self._controller.check(points, from_stamp(request.trajectory.header.stamp))
        except Rejected as reason:
            self.rejections.append(str(reason))
            self._node.get_logger().warning(f"goal rejected: {reason}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _on_accepted(self, handle: ServerGoalHandle) -> None:
        request = handle.request
        stamp = from_stamp(request.trajectory.header.stamp)
        with self._lock:
            goal = self._controller.follow(self._points(request.trajectory), stamp, self._tolerances(request))
            running = Running(goal, Future(executor=self._node.executor))
            self._running.append(running)
        self._accepted[bytes(handle.goal_id.uuid)] = running
        handle.execute()

    async def _execute(self, handle: ServerGoalHandle) -> FollowJointTrajectory.Result:
        running = self._accepted.pop(bytes(handle.goal_id.uuid))
        await running.ending
        goal = running.goal
        end = {
            Outcome.SUCCEEDED: handle.succeed,
            Outcome.ABORTED: handle.abort,
            Outcome.CANCELED: handle.canceled,
        }
        assert goal.outcome is not None
        end[goal.outcome]()
        return FollowJointTrajectory.Result(error_code=goal.error_code, error_string=goal.error)

    def _on_cancel(self, _: ServerGoalHandle) -> CancelResponse:
        with self._lock:
            self._controller.cancel()
        return CancelResponse.ACCEPT

    def _points(self, message: JointTrajectory) -> tuple[Waypoint, ...]:
        if sorted(message.joint_names) != sorted(self._joints):
            raise Rejected(f"joints {list(message.joint_names)} instead of {list(self._joints)}")
        order = [list(message.joint_names).index(name) for name in self._joints]

        def column(values: list[float]) -> Array | None:
            return np.array(values, dtype=float)[order] if len(values) == len(order) else None

        points = []
        for point in message.points:
            if (q := column(point.positions)) is None:
                raise Rejected("a point without a position of each joint")
            offset = from_stamp(point.time_from_start)
            others = (column(values) for values in (point.velocities, point.accelerations, point.effort))
            points.append(Waypoint(offset, q, *others))
        return tuple(points)

    def _tolerances(self, request: FollowJointTrajectory.Goal) -> Tolerances:
        defaults = self._controller.defaults
        path = self._stated(request.path_tolerance, defaults.path)
        goal = self._stated(request.goal_tolerance, defaults.goal)
        return Tolerances(path, goal, from_stamp(request.goal_time_tolerance) or defaults.goal_time)

    def _stated(self, stated: list[JointTolerance], defaults: Array) -> Array:
        """Allowed errors: 0 leaves the default, -1 lifts it."""
        allowed = defaults.copy()
        for tolerance in stated:
            if tolerance.position:
                allowed[self._joints.index(tolerance.name)] = max(tolerance.position, 0.0)
        return allowed

    def _state_message(self) -> JointTrajectoryControllerState:
        state = self._controller.state
        assert state is not None
        q, v, a = state.reference
        message = JointTrajectoryControllerState(
            joint_names=list(self._joints), speed_scaling_factor=state.scaling,
            reference=JointTrajectoryPoint(
                positions=q.tolist(), velocities=v.tolist(), accelerations=a.tolist()
            ),
            feedback=JointTrajectoryPoint(positions=state.q.tolist(), velocities=state.v.tolist()),
            error=JointTrajectoryPoint(positions=(q - state.q).tolist(), velocities=(v - state.v).tolist()),
            output=JointTrajectoryPoint(positions=q.tolist()),
        )  # fmt: skip
        message.header.stamp = to_stamp(state.time)
        return message
