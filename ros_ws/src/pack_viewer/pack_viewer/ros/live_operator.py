"""Asks a running cell for what is pressed on the page."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from action_msgs.srv import CancelGoal
from pack_interfaces.msg import ArmState, NodeStatus, SimulationState
from pack_interfaces.srv import SetSimulationState, StopArm
from rclpy.action import ActionClient
from rclpy.task import Future
from std_srvs.srv import Trigger

from pack_core.errors import PackError
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.node_status import LISTENING
from pack_viewer.cell_condition import CellCondition
from pack_viewer.event_log import EventLog
from pack_viewer.ros.run_form import RunForm

ANSWER = 20.0
"""Longest wait for the answer to a request [s of wall clock]; a reset builds a model."""
SETTLE = 1.0
"""Wait after a reset, so that every node has heard of the new scene [s of wall clock]."""


class LiveOperator:
    """Sends requests to the cell, from threads of its own, and keeps what the cell is at.

    Args:
        node: who asks; it must be spun meanwhile.
        action: the cell's action.
        form: what the next goal is.
        log: is told how requests went.
    """

    def __init__(self, node: CellNode, action: Contract, form: RunForm, log: EventLog) -> None:
        self._node, self._form, self._log = node, form, log
        (self._server,) = action.targets
        self._action = ActionClient(node, action.type, action.name)
        # A cancel request without a goal's id is for all goals, so that anybody's goal can be ended.
        self._cancel = node.create_client(CancelGoal, f"{action.name}/_action/cancel_goal")
        self._pause = self._client(shared.SET_SIMULATION_STATE)
        self._stop = self._client(shared.STOP_ARM)
        self._resume = self._client(shared.RESUME_ARM)
        self._reset: Any = None
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
        reset, goal = self._form.reset(), self._form.goal()
        self._note(is_starting=True)
        self._in_thread(lambda: self._run(reset, goal[1], who))

    def cancel(self, who: str) -> None:
        """End whatever goal is in progress."""
        self._node.get_logger().info(f"{who} cancels the goal")
        self._in_thread(lambda: self._ask(self._cancel, CancelGoal.Request()))

    def set_paused(self, paused: bool, who: str) -> None:
        """Let simulated time stand still, or run on."""
        state = SimulationState.STATE_PAUSED if paused else SimulationState.STATE_PLAYING
        request = SetSimulationState.Request(state=SimulationState(state=state))
        self._node.get_logger().info(f"{who} {'pauses the simulator' if paused else 'lets it go on'}")

        def act() -> None:
            answer = self._ask(self._pause, request)
            if answer.result.error_message:
                raise PackError(answer.result.error_message)

        self._in_thread(act)

    def stop(self, who: str) -> None:
        """Brake the arm at once."""
        self._node.get_logger().warning(f"{who} stops the arm")
        request = StopArm.Request(reason=f"STOP on the page, {who}")
        self._in_thread(lambda: self._ask(self._stop, request))

    def resume(self, who: str) -> None:
        """Let the arm follow setpoints again."""
        self._node.get_logger().info(f"{who} lets the arm go on")
        self._in_thread(lambda: self._ask(self._resume, Trigger.Request()))

    def _run(self, reset: tuple[Contract, Any], goal: Any, who: str) -> None:
        try:
            self._reset = self._reset or self._client(reset[0])
            answer = self._ask(self._reset, reset[1])
            if not answer.success:
                raise PackError(f"the cell cannot be put into the chosen scene: {answer.message}")
            time.sleep(SETTLE)
            self._node.get_logger().info(f"{who} starts a goal")
            handle = _wait(self._action.send_goal_async(goal), ANSWER)
            if not handle.accepted:
                raise PackError(f"node {self._server} does not take the goal; its log says why")
        finally:
            self._note(is_starting=False)
        result = _wait(handle.get_result_async(), None).result
        if not result.success:
            raise PackError(f"goal of {who}: {result.message}")

    def _ask(self, client: Any, request: Any) -> Any:
        if not client.service_is_ready():
            raise PackError(f"nobody serves {client.srv_name}: is the simulator up?")
        return _wait(client.call_async(request), ANSWER)

    def _client(self, contract: Contract) -> Any:
        return self._node.create_client(contract.type, contract.name)

    def _in_thread(self, act: Callable[[], Any]) -> None:
        def run() -> None:
            try:
                act()
            except PackError as error:
                self._log.add(str(error), "error")

        threading.Thread(target=run, name="operator", daemon=True).start()

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


def _wait(future: Future, timeout: float | None) -> Any:
    """The result of what the executor is at, waited for in another thread; raises PackError."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    if not done.wait(timeout):
        raise PackError(f"no answer within {timeout:.0f} s")
    return future.result()
