"""The controller as a ROS 2 node: actions `/pack_object` and `/fill_container` in, joint setpoints out."""

from __future__ import annotations

import json
import math
import threading
from dataclasses import asdict
from typing import Any

from pack_interfaces.action import FillContainer, PackObject
from pydantic import Field, PositiveFloat
from std_msgs.msg import String

from pack_core.errors import PackError
from pack_core.joints import Setpoints
from pack_core.packing.arrangement import FillMethod
from pack_core.packing.exit_reason import PackingExitReason
from pack_core.packing.method import PackingMethod
from pack_core.packing.packing_list import parse_list
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.joint_messages import to_setpoints
from pack_core.ros.packing.cell_parameter import read_packing_cell
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_mpc.optimizers import optimizer_class
from pack_mpc.ros.fill_goal import FillClients, FillGoal
from pack_mpc.ros.fill_messages import to_fill_feedback, to_fill_report, to_fill_result
from pack_mpc.ros.mailbox import Mailbox
from pack_mpc.ros.placement_client import PlacementClient
from pack_mpc.ros.status import to_feedback, to_result, to_status
from pack_mpc.session import PackingSession, SessionConfig, hold
from pack_mpc.weights import load_weights
from pack_mpc.worker import Worker, WorkerConfig

DONE = "done"
"""Exit reason of a fill job that came to the end of its list."""
CHECK_PERIOD = 0.1
"""Time between two looks whether the goal's time has run out [s of wall clock]."""


class MpcNodeConfig(SessionConfig):
    """Parameters of the node `mpc`."""

    worker: WorkerConfig = WorkerConfig()
    watched: tuple[str, ...] = Field(
        default=("sim", "perception", "planner", "recorder"), description="the arm holds while one is silent"
    )
    fault_time: PositiveFloat = Field(default=1.0, description="silence that ends a goal [s of wall clock]")


class MpcNode(GoalNode):
    """Packs the held object, or the objects of a list: plans in a worker thread, as fast as it can."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("mpc", **kwargs)
        self._change(read_parameters(self, MpcNodeConfig, self._change))
        self._cell = read_packing_cell(self)
        self._scene: Scene | None = None
        self._session: PackingSession | None = None
        self._filling: FillGoal | None = None
        self._fill_end = ("", "")
        self._sending = threading.Lock()
        self._mailbox = Mailbox(self, self._cell.robot.arm.joints)
        self._placements = PlacementClient(self)
        self._fill_clients = FillClients(self)
        self._setpoints = self.advertise(contracts.SETPOINTS)
        self._status = self.advertise(contracts.MPC_STATUS)
        self._result = self.advertise(contracts.RESULT)
        self._fill_result = self.advertise(contracts.FILL_RESULT)
        self.listen(contracts.DESCRIPTION, self._on_description)
        self.create_timer(CHECK_PERIOD, self._expire, clock=self.wall)
        self._worker = Worker(self._iterate, self._config.worker, self._on_error)
        self.take_goals(
            contracts.PACK_OBJECT, self._config.watched, self._config.fault_time, contracts.FILL_CONTAINER
        )

    def _change(self, config: MpcNodeConfig) -> None:
        """Use these parameters from the next goal on."""
        load_weights(config.weights)  # what there is not is found now, not at the next goal
        optimizer_class(config.controller.optimizer).require()
        self._config = config

    @property
    def waits_for(self) -> str:
        if self._scene is None:
            return f"no {contracts.DESCRIPTION.name} yet: is sim up?"
        return self._mailbox.missing(self._scene)

    def destroy_node(self) -> None:
        """Stop the worker before the node that it publishes with."""
        self._worker.stop()
        super().destroy_node()

    def _on_description(self, message: String) -> None:
        self._scene = Scene.from_yaml(message.data, contracts.DESCRIPTION.name)

    def refusal(self, request: PackObject.Goal | FillContainer.Goal) -> str:
        if isinstance(request, FillContainer.Goal):
            FillMethod.of(request.method)  # raises when there is none
            parse_list(request.list, "goal", self._cell)
            if self._scene is None:
                return self.waits_for
            held = self._scene.new_object.name
            return f"the pump holds '{held}'; allowed: an empty cup" if self._mailbox.is_held else ""
        if reason := self.waits_for:
            return reason
        _method_of(request)  # raises when there is none
        if not 0.0 <= request.timeout < math.inf:
            return f"timeout {request.timeout}; allowed: seconds from 0 on; 0: the parameter task.timeout"
        return ""

    async def pursue(self, request: PackObject.Goal | FillContainer.Goal) -> Any:
        """Hand the goal to the worker and wait for its outcome."""
        if isinstance(request, FillContainer.Goal):
            return await self._fill(request)
        return await self._pack(request)

    async def _fill(self, request: FillContainer.Goal) -> FillContainer.Result:
        given, method = parse_list(request.list, "goal", self._cell), FillMethod.of(request.method)
        self._mailbox.clear_forces()
        goal = FillGoal(
            self._fill_clients, self._placements, self._cell, self._config, given, method, request.seed,
            self._described, self._mailbox.time,
        )  # fmt: skip
        self._fill_end, self._filling = ("", ""), goal
        self._worker.wake()
        await self.until_goal_ends()
        self._fill_result.publish(String(data=to_fill_report(goal, *self._fill_end)))
        return to_fill_result(goal, self._mailbox.time, *self._fill_end)

    def _described(self) -> Scene:
        assert self._scene is not None
        return self._scene

    async def _pack(self, request: PackObject.Goal) -> PackObject.Result:
        assert self._scene is not None
        method, now = _method_of(request), self._mailbox.time
        session = PackingSession(self._scene, self._cell, self._config, method, now, request.timeout)
        self._placements.start(request.seed)
        self._mailbox.clear_forces()
        self._session = session
        self._worker.wake()
        await self.until_goal_ends()
        outcome = json.dumps(asdict(session.task.outcome), default=lambda reason: reason.value)
        self._result.publish(String(data=outcome))
        return to_result(session)

    def describe(self, result: PackObject.Result) -> str:
        return f"{result.exit_reason}, {result.message}"

    def _iterate(self, latency: float) -> float | None:
        """Plan once from the newest messages, in the worker's thread; the latency is returned [s]."""
        if self._filling is not None:
            return self._turn(self._filling, latency)
        session = self._session
        if session is None:
            return None
        self._worker.wake()  # again after this turn, until the goal has ended
        if not self._mailbox.wait_for_joints() or self.silent_peers:
            return None
        seen = self._mailbox.observe()
        if self.is_cancel_requested:
            session.task.finish(PackingExitReason.CANCELED, seen.joints.time, "on request")
        self._placements.serve(session, seen)
        plan = session.step(seen, latency)
        if session.task.outcome is not None:
            self._end(session)
            return None
        if plan is None or not self._send(session, plan.setpoints):
            return None
        self.failures.passed("iteration")
        self._status.publish(to_status(session, seen, plan))
        self.publish_feedback(to_feedback(session, seen, plan))
        return self._mailbox.time - seen.joints.time

    def _turn(self, goal: FillGoal, latency: float) -> float | None:
        """One turn of a fill job, in the worker's thread; the latency of a plan is returned [s]."""
        self._worker.wake()
        if not self._mailbox.wait_for_joints() or self.silent_peers:
            return None
        seen = self._mailbox.observe()
        if self.is_cancel_requested:
            self._end_filling(goal, PackingExitReason.CANCELED.value, "on request")
            return None
        turn = goal.turn(seen, self._mailbox.force, latency)
        if goal.job.is_done:
            self._end_filling(goal, DONE, goal.job.report.message)
            return None
        if turn.setpoints is None or not self._send(goal, turn.setpoints):
            return None
        self.publish_feedback(to_fill_feedback(goal, seen.joints.time))
        if turn.plan is None or goal.session is None:
            return None
        self._status.publish(to_status(goal.session, seen, turn.plan))
        return self._mailbox.time - seen.joints.time

    def _end_filling(self, goal: FillGoal, exit_reason: str, message: str) -> None:
        """Hold the arm and let the action return."""
        with self._sending:
            if self._filling is not goal:
                return
            self._filling, self._fill_end = None, (exit_reason, message)
            self._hold()
        self.end_goal()

    def _send(self, goal: PackingSession | FillGoal, setpoints: Setpoints) -> bool:
        """Publish setpoints, unless the goal ended or a peer fell silent while they were planned."""
        with self._sending:
            is_wanted = goal in (self._session, self._filling) and not self.silent_peers
            if is_wanted:
                self._setpoints.publish(to_setpoints(setpoints, self._cell.robot.arm.joints))
        return is_wanted

    def _end(self, session: PackingSession) -> None:
        """Hold the arm and let the action return."""
        with self._sending:
            if self._session is not session:
                return
            self._session = None
            self._hold()
        self.end_goal()

    def _hold(self) -> None:
        if self._mailbox.joints is not None:
            self._setpoints.publish(to_setpoints(hold(self._mailbox.joints), self._cell.robot.arm.joints))

    def on_peer(self, peer: str, is_alive: bool) -> None:
        """Hold the arm as soon as a peer falls silent; setpoints planned before are not sent after it."""
        with self._sending:
            super().on_peer(peer, is_alive)
            if not is_alive:
                self._hold()

    def on_lost_peers(self, peers: list[str]) -> None:
        self._fail(f"silent: {', '.join(peers)}")

    def on_arm_stop(self, reason: str) -> None:
        self._fail(reason)

    def give_up(self) -> None:
        if self._session is not None:
            self._end(self._session)

    def _fail(self, reason: str) -> None:
        if (session := self._session) is not None:
            session.task.finish(PackingExitReason.FAULT, self._mailbox.time, reason)
            self._end(session)

    def _expire(self) -> None:
        """End a goal whose time ran out while the worker had nothing to plan from."""
        if (session := self._session) is not None:
            session.task.expire(self._mailbox.time)
            if session.task.outcome is not None:
                self._end(session)

    def _on_error(self, error: Exception) -> None:
        if isinstance(error, PackError):
            self.health.count("skipped iteration", str(error))
            self.get_logger().warning(f"iteration skipped: {error}", throttle_duration_sec=1.0)
        elif self.context.ok() and self.failures.note("iteration", error):
            self.react_to_failure(f"every iteration fails: {error!r}")


def _method_of(request: PackObject.Goal) -> PackingMethod:
    return PackingMethod.of(request.method) if request.method else PackingMethod.PACK_IT_IN


def main() -> int:
    """Entry point of `mpc_node`."""
    return run_node(MpcNode)
