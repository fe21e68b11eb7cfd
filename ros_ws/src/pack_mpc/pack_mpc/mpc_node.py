"""The controller as a ROS 2 node: action `/pack_object` in, joint setpoints out."""

from __future__ import annotations

import json
import math
import threading
import time
from dataclasses import asdict
from typing import Any

from pack_interfaces.action import PackObject
from pydantic import Field, PositiveFloat
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from std_msgs.msg import String

from pack_core.errors import PackError
from pack_core.packing.exit_reason import ExitReason
from pack_core.packing.scene import Scene
from pack_core.robots import panda
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.joint_messages import to_setpoints
from pack_core.ros.packing.cell_parameter import read_packing_cell
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_core.ros.silence import Silence
from pack_mpc.controller import Plan
from pack_mpc.ros.mailbox import Mailbox
from pack_mpc.ros.placement_client import PlacementClient
from pack_mpc.ros.status import to_feedback, to_result, to_status
from pack_mpc.session import Method, PackingSession, SessionConfig, hold
from pack_mpc.weights import load_weights
from pack_mpc.worker import Worker, WorkerConfig


class MpcNodeConfig(SessionConfig):
    """Parameters of the node `mpc`."""

    worker: WorkerConfig = WorkerConfig()
    watched: tuple[str, ...] = Field(
        default=("sim", "perception", "planner", "recorder"),
        description="the arm holds while one of them is silent",
    )
    fault_time: PositiveFloat = Field(default=1.0, description="silence that ends a goal [s of wall clock]")


class MpcNode(CellNode):
    """Accepts one goal at a time and plans for it in a worker thread."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("mpc", **kwargs)
        self._config = read_parameters(self, MpcNodeConfig)
        self._cell = read_packing_cell(self)
        load_weights(self._config.weights)  # a set that does not exist is found now, not at the first goal
        self._scene: Scene | None = None
        self._session: PackingSession | None = None
        self._done: Future | None = None
        self._goal: ServerGoalHandle | None = None
        self._is_busy = False
        self._silence = Silence()
        self._sending = threading.Lock()
        self._mailbox = Mailbox(self)
        self._placements = PlacementClient(self)
        self._setpoints = self.advertise(contracts.SETPOINTS)
        self._status = self.advertise(contracts.MPC_STATUS)
        self._result = self.advertise(contracts.RESULT)
        self.listen(contracts.DESCRIPTION, self._on_description)
        self._action = ActionServer(
            self, contracts.PACK_OBJECT.type, contracts.PACK_OBJECT.name, self._execute,
            goal_callback=self._on_goal, cancel_callback=lambda _: CancelResponse.ACCEPT,
        )  # fmt: skip
        self.watch(self._config.watched, self._on_peer)
        self.create_timer(0.1, self._check, clock=self.wall)
        self._worker = Worker(self._iterate, self._config.worker, self._on_error)
        self._mailbox.on_joints = self._worker.wake

    @property
    def missing(self) -> str:
        """What a goal needs and has not been heard of yet; empty: nothing."""
        if self._scene is None:
            return f"no {contracts.DESCRIPTION.name} yet: is sim up?"
        return self._mailbox.missing(self._scene)

    @property
    def is_ready(self) -> bool:
        """Whether the cell is described, and its joints and objects have been seen."""
        return not self.missing

    def destroy_node(self) -> None:
        """Stop the worker, then the node."""
        self._worker.stop()
        self._action.destroy()
        super().destroy_node()

    def _on_description(self, message: String) -> None:
        self._scene = Scene.from_yaml(message.data, contracts.DESCRIPTION.name)

    def _on_goal(self, goal: PackObject.Goal) -> GoalResponse:
        reason = self._refusal(goal)
        if not reason:
            self._is_busy = True
            return GoalResponse.ACCEPT
        self.health.count("refused goal", reason)
        self.get_logger().error(f"refused goal: {reason}")
        return GoalResponse.REJECT

    def _refusal(self, goal: PackObject.Goal) -> str:
        """Why a goal cannot be pursued; empty when it can."""
        if self._is_busy:
            return "a goal is in progress; cancel it first"
        if self.missing:
            return self.missing
        if self._silence:
            return f"silent: {self._silence}"
        methods = [method.value for method in Method]
        if goal.method not in methods:
            return f"method '{goal.method}'; allowed: {', '.join(methods)}"
        if not 0.0 <= goal.timeout < math.inf:
            return f"timeout {goal.timeout}; allowed: seconds from 0 on, 0 being the parameter task.timeout"
        return ""

    async def _execute(self, goal: ServerGoalHandle) -> PackObject.Result:
        try:
            session = await self._pursue(goal)
        finally:
            self._is_busy = False
        result = to_result(session)
        outcome = json.dumps(asdict(session.task.outcome), default=lambda reason: reason.value)
        self._result.publish(String(data=outcome))
        self.get_logger().info(f"goal ended: {result.exit_reason}, {result.message}")
        if result.exit_reason == ExitReason.CANCELED.value:
            goal.canceled()
        elif result.success:
            goal.succeed()
        else:
            goal.abort()
        return result

    async def _pursue(self, goal: ServerGoalHandle) -> PackingSession:
        """Hand the goal to the worker and wait for its outcome."""
        assert self._scene is not None
        request, now = goal.request, self._mailbox.time
        session = PackingSession(
            self._scene, self._cell, self._config, Method.of(request.method), now, request.timeout
        )
        self._placements.start(session, request.seed)
        self._mailbox.clear_forces()
        self._done, self._goal = Future(executor=self.executor), goal
        self._session = session
        await self._done
        return session

    def _iterate(self, latency: float) -> float | None:
        """One turn of the worker."""
        session, goal = self._session, self._goal
        if session is None or goal is None or self._silence:
            return None
        seen = self._mailbox.observe()
        if goal.is_cancel_requested:
            session.task.finish(ExitReason.CANCELED, seen.joints.time, "on request")
        self._placements.serve(session, seen)
        plan = session.step(seen, latency)
        if session.task.outcome is not None:
            self._end(session)
            return None
        if plan is None or not self._send(session, plan):
            return None
        self._status.publish(to_status(session, seen, plan))
        goal.publish_feedback(to_feedback(session, seen, plan))
        return self._mailbox.time - seen.joints.time

    def _send(self, session: PackingSession, plan: Plan) -> bool:
        """Publish setpoints, unless the goal ended or a peer fell silent while they were planned."""
        with self._sending:
            is_wanted = self._session is session and not self._silence
            if is_wanted:
                self._setpoints.publish(to_setpoints(plan.setpoints, panda.JOINTS))
        return is_wanted

    def _end(self, session: PackingSession) -> None:
        """Hold the arm and let the action return."""
        with self._sending:
            if self._session is not session or self._done is None:
                return
            self._session = None
            self._hold()
        self._done.set_result(None)

    def _hold(self) -> None:
        if self._mailbox.joints is not None:
            self._setpoints.publish(to_setpoints(hold(self._mailbox.joints), panda.JOINTS))

    def _on_peer(self, peer: str, is_alive: bool) -> None:
        with self._sending:
            self._silence.note(peer, is_alive, time.monotonic())
            if not is_alive:
                self._hold()

    def _check(self) -> None:
        """End a goal that the worker cannot: its peers stay silent, or its time ran out unobserved."""
        session = self._session
        if session is None:
            return
        if lost := self._silence.lasting(self._config.fault_time, time.monotonic()):
            session.task.finish(ExitReason.FAULT, self._mailbox.time, f"silent: {', '.join(lost)}")
        session.task.expire(self._mailbox.time)
        if session.task.outcome is not None:
            self._end(session)

    def _on_error(self, error: Exception) -> None:
        if not self.context.ok():
            return
        log = self.get_logger()
        if isinstance(error, PackError):
            self.health.count("skipped iteration", str(error))
            log.warning(f"iteration skipped: {error}", throttle_duration_sec=1.0)
        else:
            self.health.count("failed iteration", str(error))
            log.error(f"iteration failed: {error!r}", throttle_duration_sec=1.0)


def main() -> int:
    """Entry point of `mpc_node`."""
    return run_node(MpcNode)
