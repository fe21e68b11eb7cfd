"""Asks a running cell for what is pressed on the page."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from action_msgs.srv import CancelGoal
from pack_interfaces.msg import ArmState, NodeStatus, SimulationState
from pack_interfaces.srv import SetSimulationState, StopArm
from rclpy.task import Future
from std_srvs.srv import Trigger

from pack_core.errors import PackError
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.goal_sender import GoalSender
from pack_core.ros.node import CellNode
from pack_core.ros.node_status import LISTENING
from pack_viewer.event_log import EventLog
from pack_viewer.ros.run_form import RunForm
from pack_viewer.run_panel import CellCondition

ANSWER = 5.0
"""A request without an answer for this long is told of [s of wall clock]."""


class LiveOperator:
    """Sends requests to the cell and keeps what the cell is at; nothing waits for an answer.

    Args:
        node: who asks; it must be spun meanwhile.
        actions: the cell's actions, all of one node.
        form: what the next goal is.
        log: is told how requests went.
    """

    def __init__(self, node: CellNode, actions: Sequence[Contract], form: RunForm, log: EventLog) -> None:
        self._node, self._form, self._log = node, form, log
        (self._server,) = {server for action in actions for server in action.targets}
        self._senders: dict[str, GoalSender] = {}
        # A cancel request without a goal's id is for all goals, so that anybody's goal can be ended.
        self._cancels = [
            node.create_client(CancelGoal, f"{action.name}/_action/cancel_goal") for action in actions
        ]
        self._pause = self._client(shared.SET_SIMULATION_STATE)
        self._stop = self._client(shared.STOP_ARM)
        self._resume = self._client(shared.RESUME_ARM)
        self._condition = CellCondition(waits_for=f"waiting for node {self._server}")
        self._lock = threading.Lock()
        node.create_subscription(NodeStatus, shared.NODE_STATUS.name, self._on_node, LISTENING)
        node.listen(shared.SIMULATION_STATE, self._on_simulation)
        node.listen(shared.ARM_STATE, self._on_arm)

    @property
    def condition(self) -> CellCondition:
        """What the cell is at."""
        return self._condition

    def start(self, who: str) -> None:
        """Reset the cell and send the goal; raises PackError where the form holds none."""
        if not self._condition.can_start:
            raise PackError(f"no goal can be started now: {self._condition.in_words}")
        (service, request), (action, goal) = self._form.reset(), self._form.goal()
        self._node.get_logger().info(f"{who} starts a goal")
        self._note(is_starting=True)
        if action.name not in self._senders:
            note = partial(self._on_goal, action.name)
            self._senders[action.name] = GoalSender(self._node, action, service, on_change=note)
        self._senders[action.name].send(goal, request)

    def cancel(self, who: str) -> None:
        """End whatever goal is in progress."""
        self._node.get_logger().info(f"{who} cancels the goal")
        for client in self._cancels:
            self._ask(client, CancelGoal.Request())

    def set_paused(self, paused: bool, who: str) -> None:
        """Let simulated time stand still, or run on."""
        state = SimulationState.STATE_PAUSED if paused else SimulationState.STATE_PLAYING
        request = SetSimulationState.Request(state=SimulationState(state=state))
        self._node.get_logger().info(f"{who} {'pauses the simulator' if paused else 'lets it go on'}")
        self._ask(self._pause, request, lambda answer: answer.result.error_message)

    def stop(self, who: str) -> None:
        """Brake the arm at once."""
        self._node.get_logger().warning(f"{who} stops the arm")
        request = StopArm.Request(reason=f"STOP on the page, {who}")
        self._ask(self._stop, request)

    def resume(self, who: str) -> None:
        """Let the arm follow setpoints again."""
        self._node.get_logger().info(f"{who} lets the arm go on")
        self._ask(self._resume, Trigger.Request())

    def _on_goal(self, action: str) -> None:
        """A goal was taken, has ended or has failed."""
        sender = self._senders[action]
        self._note(is_starting=sender.is_starting)
        if sender.failure:
            self._log.add(sender.failure, "error")

    def _ask(self, client: Any, request: Any, problem: Callable[[Any], str] = lambda _: "") -> None:
        """Call a service; `problem` finds in the answer why it was refused."""
        if not client.service_is_ready():
            raise PackError(f"nobody serves {client.srv_name}: is the simulator up?")

        def on_answer(future: Future) -> None:
            if reason := problem(future.result()):
                self._log.add(reason, "error")

        future = client.call_async(request)
        future.add_done_callback(on_answer)

        def look() -> None:
            self._node.destroy_timer(timer)
            if not future.done():
                self._log.add(f"{client.srv_name} has not answered for {ANSWER:.0f} s", "error")

        timer = self._node.create_timer(ANSWER, look, clock=self._node.wall)

    def _client(self, contract: Contract) -> Any:
        return self._node.create_client(contract.type, contract.name)

    def _on_node(self, status: NodeStatus) -> None:
        if status.name == self._server:
            is_waiting = status.state in (NodeStatus.STARTING, NodeStatus.WAITING)
            waits_for = (status.waits_for or "starting") if is_waiting else ""
            self._note(is_busy=status.state == NodeStatus.BUSY, waits_for=waits_for)

    def _on_simulation(self, state: SimulationState) -> None:
        self._note(is_up=True, is_paused=state.state == SimulationState.STATE_PAUSED)

    def _on_arm(self, state: ArmState) -> None:
        if state.is_stopped and not self._condition.is_stopped:
            self._log.add(f"the arm is stopped: {state.reason}", "warning")
        self._note(is_up=True, is_stopped=state.is_stopped)

    def _note(self, **changes: Any) -> None:
        with self._lock:
            self._condition = replace(self._condition, **changes)
