"""The client of one goal, from the first word of the cell to the result, and its turns until then."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from pack_interfaces.msg import NodeStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from pack_bringup.ros.deferred_signals import deferred_signals
from pack_core.errors import PackError
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.goal_sender import LOST, GoalSender
from pack_core.ros.node import CellNode
from pack_core.ros.node_status import LISTENING
from pack_core.ros.run import confirm_network, start_ros
from pack_core.ros.simulation_types import SimulationState
from pack_core.ros.watch.peer_watch import SilentPeers, alive_topic

GRACE = 1.0
"""After the end of whoever pursued the goal, in which its result may still arrive [s of wall clock]."""
SILENCE = 10.0
"""Of whoever pursues the goal, after which it counts as lost [s of wall clock]: it hangs, or is elsewhere."""


class GoalClient(CellNode):
    """One goal: sent when every node is ready, then followed to its result or to the end of who pursues it.

    Args:
        contract: the action.
        goal: its message.
        peers: nodes that must be ready before it is sent.
        reset: a service and its request, which puts the cell into the goal's scene first; None: no reset.

    Attributes:
        real_time_factor: as the simulator reports it.
        is_paused: whether the simulator stands still on request, so that nothing is to be expected.
        factors: those reported while the goal was pursued.
        iterations_ms: what the controller's iterations took, where its feedback says so [ms of wall clock].
    """

    may_be_repeated = True

    def __init__(
        self,
        contract: Contract,
        goal: Any,
        peers: Sequence[str],
        reset: tuple[Contract, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__("goal", **kwargs)
        self._goal, self._peers = goal, peers
        service, self._request = reset or (None, None)
        self._sender = GoalSender(
            self, contract, service, on_feedback=self._on_feedback, is_ready=lambda: not self.missing
        )
        self._statuses: dict[str, NodeStatus] = {}
        self._silent, self._gone = SilentPeers(), SilentPeers()
        self.watch(contract.targets, self._on_server)
        self._is_complete = False
        self.real_time_factor = 0.0
        self.is_paused = False
        self.factors: list[float] = []
        self.iterations_ms: list[float] = []
        self.listen(shared.REAL_TIME_FACTOR, self._on_real_time_factor)
        self.listen(shared.SIMULATION_STATE, self._on_simulation_state)
        status = shared.NODE_STATUS
        self.create_subscription(status.type, status.name, self._on_status, LISTENING)

    @property
    def is_sent(self) -> bool:
        """Whether the goal is on its way, or was taken."""
        return self._sender.is_sent

    @property
    def is_accepted(self) -> bool:
        """Whether the goal was taken."""
        return self._sender.is_accepted

    @property
    def feedback(self) -> Any:
        """The newest, if any."""
        return self._sender.feedback

    @property
    def result(self) -> Any:
        """Of the goal, once it has ended."""
        return self._sender.result

    @property
    def missing(self) -> dict[str, str]:
        """Nodes of the cell that are not ready, each with the reason in words."""
        found = {}
        for peer in self._peers:
            status = self._statuses.get(peer)
            if status is None or not self.count_publishers(self.in_cell(alive_topic(peer))):
                found[peer] = "not up"
            elif status.state in (NodeStatus.STARTING, NodeStatus.WAITING):
                found[peer] = status.waits_for or "starting"
        return found

    def pursue(self) -> None:
        """Take the next step towards the goal: to be called again and again.

        Raises:
            PackError: another goal is in progress, the cell cannot be reset, the goal was refused, or whoever
                pursues it has ended or is silent.
        """
        if not self._is_complete and not self.missing:
            self._is_complete = True
            self._require_peace()
            self._sender.send(self._goal, self._request)
        if self._sender.failure:
            raise PackError(self._sender.failure)
        if self.is_accepted and self.result is None:
            self._require_server()

    def on_peer_end(self, peer: str) -> None:
        """Whether it comes back or not, it has forgotten a goal that was sent to it."""
        if self.is_sent:
            self._gone.note(peer, False, time.monotonic())

    def cancel(self) -> None:
        """Have the goal ended as soon as it has been taken; its result comes as of any goal."""
        self._sender.cancel()

    def _require_peace(self) -> None:
        """Refuse to reset a cell with a goal in progress: the scene would be pulled away from under it."""
        busy = [name for name, status in self._statuses.items() if status.state == NodeStatus.BUSY]
        if busy and self._request is not None:
            raise PackError(f"node '{busy[0]}' pursues a goal: wait for it, or cancel it where it was sent")

    def _on_server(self, peer: str, is_alive: bool) -> None:
        self._silent.note(peer, is_alive, time.monotonic())

    def _require_server(self) -> None:
        now = time.monotonic()
        for peer in self._gone.lasting(GRACE, now):
            raise PackError(f"{LOST}: node '{peer}' has ended; its log says why")
        for peer in self._silent.lasting(SILENCE, now):
            raise PackError(f"{LOST}: nothing was heard of node '{peer}' for {SILENCE:.0f} s")

    def _on_status(self, status: NodeStatus) -> None:
        self._statuses[status.name] = status

    def _on_feedback(self, feedback: Any) -> None:
        if hasattr(feedback, "iteration_ms"):
            self.iterations_ms.append(feedback.iteration_ms)

    def _on_real_time_factor(self, message: Any) -> None:
        self.real_time_factor = message.data
        if self.is_accepted and self.result is None:
            self.factors.append(message.data)

    def _on_simulation_state(self, message: SimulationState) -> None:
        self.is_paused = message.state == SimulationState.STATE_PAUSED


def follow_goal(
    make: Callable[[], GoalClient],
    on_turn: Callable[[GoalClient], None],
    *,
    domain: int | None = None,
    linger: float = 0.0,
) -> Any:
    """Send a goal and wait for its result, leaving signals to the caller.

    Args:
        make: builds the node that sends it.
        on_turn: is called about ten times a second of wall clock; what it raises ends the wait.
        domain: ROS domain; the environment's if None.
        linger: wall clock to stay after the result, so that the end is recorded [s].
    """
    start_ros(domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    executor, node = SingleThreadedExecutor(), None
    try:
        node = make()
        confirm_network()
        executor.add_node(node)
        while node.result is None:
            _turn(executor, node, on_turn)
        end = time.monotonic() + linger
        while time.monotonic() < end:
            _turn(executor, node, on_turn)
        return node.result
    finally:
        executor.shutdown()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def _turn(executor: SingleThreadedExecutor, node: GoalClient, on_turn: Callable[[GoalClient], None]) -> None:
    end = time.monotonic() + 0.1
    while (rest := end - time.monotonic()) > 0.0:
        with deferred_signals():
            executor.spin_once(timeout_sec=rest)
    node.pursue()
    on_turn(node)
