"""Asks a running cell for what its operators want, and keeps what the cell is at."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from action_msgs.srv import CancelGoal
from pack_interfaces.msg import ArmState, NodeStatus
from pack_interfaces.srv import StopArm
from rclpy.task import Future
from std_srvs.srv import Trigger

from pack_core.cell_condition import CellCondition
from pack_core.errors import PackError
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.goal_sender import GoalSender
from pack_core.ros.node import CellNode
from pack_core.ros.node_status import LISTENING
from pack_core.ros.simulation_types import SetSimulationState, SimulationState

ANSWER = 5.0
"""A request without an answer for this long is told of [s of wall clock]."""

Told = Callable[[str], None]
"""Takes how a request went, once: empty if it was done, otherwise why not."""


class RunningCell:
    """Sends requests to the cell and keeps what the cell is at; nothing waits for an answer.

    Args:
        node: who asks; it must be spun meanwhile.
        actions: the cell's actions, all of one node.
        note: is told what should be known, and of what kind it is: `error` or `warning`.
        place: where stops come from, for whoever is told why the arm stands.

    Attributes:
        server: name of the node that pursues goals.
        arm: what the arm's driver said last.
    """

    def __init__(
        self, node: CellNode, actions: Sequence[Contract], note: Callable[[str, str], None], place: str
    ) -> None:
        self._node, self._note_of, self._place = node, note, place
        (self.server,) = {server for action in actions for server in action.targets}
        self._senders: dict[str, GoalSender] = {}
        self._told: dict[str, Told] = {}
        # A cancel request without a goal's id is for all goals, so that anybody's goal can be ended.
        self._cancels = [
            node.create_client(CancelGoal, f"{action.name}/_action/cancel_goal") for action in actions
        ]
        self._pause = self._client(shared.SET_SIMULATION_STATE)
        self._stop = self._client(shared.STOP_ARM)
        self._resume = self._client(shared.RESUME_ARM)
        self._resets: dict[str, Any] = {}
        self.arm = ArmState()
        self._condition = CellCondition(waits_for=f"waiting for node {self.server}")
        self._lock = threading.Lock()
        node.create_subscription(NodeStatus, shared.NODE_STATUS.name, self._on_node, LISTENING)
        node.listen(shared.SIMULATION_STATE, self._on_simulation)
        node.listen(shared.ARM_STATE, self._on_arm)
        node.watch((self.server,), self._on_server)

    @property
    def condition(self) -> CellCondition:
        """What the cell is at."""
        return self._condition

    def send(
        self, goal: tuple[Contract, Any], reset: tuple[Contract, Any] | None, who: str,
        told: Told | None = None,
    ) -> None:  # fmt: skip
        """Send a goal.

        Args:
            goal: the action, and its goal.
            reset: the service that puts the cell into the goal's scene first; None: the cell as it stands.
            who: sends it, for the log.
            told: is told once the goal is pursued, or why it is not.

        Raises:
            PackError: no goal can be started now.
        """
        if not self._condition.can_start:
            raise PackError(f"no goal can be started now: {self._condition.in_words}")
        (action, message), (service, request) = goal, reset or (None, None)
        self._node.get_logger().info(f"{who} starts a goal")
        self._note(is_starting=True)
        key = f"{action.name} {service.name if service else ''}"
        if key not in self._senders:
            note = partial(self._on_goal, key)
            self._senders[key] = GoalSender(self._node, action, service, on_change=note)
        self._told[key] = told or (lambda _: None)
        self._senders[key].send(message, request)

    def cancel(self, who: str, told: Told | None = None) -> None:
        """End whatever goal is in progress."""
        self._node.get_logger().info(f"{who} cancels the goal")
        for client in self._cancels:
            self._ask(client, CancelGoal.Request(), told=told)
            told = None  # of several actions the first one's answer is told

    def reset(self, reset: tuple[Contract, Any], who: str, told: Told | None = None) -> None:
        """Put a simulated cell into a scene; raises PackError while a goal is in progress."""
        if self._condition.is_busy or self._condition.is_starting:
            raise PackError("a goal is in progress; cancel it first")
        service, request = reset
        self._node.get_logger().info(f"{who} resets the cell")
        if service.name not in self._resets:
            self._resets[service.name] = self._client(service)
        problem = lambda answer: "" if answer.success else str(answer.message)  # noqa: E731
        self._ask(self._resets[service.name], request, problem, told)

    def set_paused(self, paused: bool, who: str) -> None:
        """Let simulated time stand still, or run on."""
        state = SimulationState.STATE_PAUSED if paused else SimulationState.STATE_PLAYING
        request = SetSimulationState.Request(state=SimulationState(state=state))
        self._node.get_logger().info(f"{who} {'pauses the simulator' if paused else 'lets it go on'}")
        self._ask(self._pause, request, lambda answer: answer.result.error_message)

    def stop(self, who: str, told: Told | None = None) -> None:
        """Brake the arm at once."""
        self._node.get_logger().warning(f"{who} stops the arm")
        self._ask(self._stop, StopArm.Request(reason=f"STOP {self._place}, {who}"), told=told)

    def resume(self, who: str, told: Told | None = None) -> None:
        """Let the arm follow setpoints again."""
        self._node.get_logger().info(f"{who} lets the arm go on")
        self._ask(self._resume, Trigger.Request(), told=told)

    def _on_goal(self, key: str) -> None:
        """A goal was taken, has ended or has failed."""
        sender = self._senders[key]
        self._note(is_starting=sender.is_starting)
        if sender.failure:
            self._note_of(sender.failure, "error")
            self._tell(key, sender.failure)
        elif sender.result is not None or self._condition.is_busy:
            self._tell(key)

    def _tell(self, key: str, reason: str = "") -> None:
        self._told.pop(key, lambda _: None)(reason)

    def _ask(
        self, client: Any, request: Any, problem: Callable[[Any], str] = lambda _: "",
        told: Told | None = None,
    ) -> None:  # fmt: skip
        """Call a service; `problem` finds in the answer why it was refused."""
        if not client.service_is_ready():
            raise PackError(f"nobody serves {client.srv_name}: is the simulator up?")

        def on_answer(future: Future) -> None:
            if reason := problem(future.result()):
                self._note_of(reason, "error")
            if told is not None:
                told(reason)

        future = client.call_async(request)
        future.add_done_callback(on_answer)

        def look() -> None:
            self._node.destroy_timer(timer)
            if not future.done():
                self._note_of(f"{client.srv_name} has not answered for {ANSWER:.0f} s", "error")

        timer = self._node.create_timer(ANSWER, look, clock=self._node.wall)

    def _client(self, contract: Contract) -> Any:
        return self._node.create_client(contract.type, contract.name)

    def _on_node(self, status: NodeStatus) -> None:
        if status.name != self.server:
            return
        is_waiting = status.state in (NodeStatus.STARTING, NodeStatus.WAITING)
        waits_for = (status.waits_for or "starting") if is_waiting else ""
        self._note(is_busy=status.state == NodeStatus.BUSY, waits_for=waits_for)
        if self._condition.is_busy:
            for key in [key for key in self._told if self._senders[key].is_accepted]:
                self._tell(key)

    def _on_server(self, server: str, is_alive: bool) -> None:
        """A node that is silent pursues no goal that anybody could end."""
        if not is_alive:
            self._note(is_busy=False, waits_for=f"node '{server}' is silent")

    def _on_simulation(self, state: SimulationState) -> None:
        self._note(is_up=True, is_paused=state.state == SimulationState.STATE_PAUSED)

    def _on_arm(self, state: ArmState) -> None:
        if state.is_stopped and not self._condition.is_stopped:
            self._note_of(f"the arm is stopped: {state.reason}", "warning")
        self.arm = state
        self._note(is_up=True, is_stopped=state.is_stopped)

    def _note(self, **changes: Any) -> None:
        with self._lock:
            self._condition = replace(self._condition, **changes)
