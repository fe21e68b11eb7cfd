"""The client of one goal: from the first word of the cell to the result."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any

from pack_interfaces.msg import NodeStatus, SimulationState
from rclpy.action import ActionClient
from rclpy.task import Future

from pack_core.errors import PackError
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.goal_refusal import REFUSED
from pack_core.ros.node_status import LISTENING
from pack_core.ros.peer_watch import alive_topic

SETTLE = 1.0
"""Wall clock [s] for which all nodes are ready before the goal is sent, so that all hear each other; and as
long after a reset, so that all have heard of what it has changed."""


class GoalClient(CellNode):
    """One goal: sent when every node is ready, then followed.

    Args:
        contract: the action.
        goal: its message.
        peers: nodes that must be ready before it is sent.
        reset: a service and its request, which puts the cell into the goal's scene first; None: no reset.

    Attributes:
        is_accepted: whether the goal was sent and heard of.
        feedback: the newest, if any.
        result: once the goal has ended.
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
        self._goal, self._peers, self._reset = goal, peers, reset
        self._statuses: dict[str, NodeStatus] = {}
        self.is_accepted = False
        self.feedback: Any = None
        self.result: Any = None
        self.real_time_factor = 0.0
        self.is_paused = False
        self.factors: list[float] = []
        self.iterations_ms: list[float] = []
        self._client = ActionClient(self, contract.type, contract.name)
        self._reset_client = self.create_client(reset[0].type, reset[0].name) if reset else None
        self._handle: Any = None
        self._is_sent = False
        self._is_cancel_wanted = False
        self._send_time = math.inf
        self._failure = ""  # what a callback found, which must not raise itself
        self._is_complete = False
        self.listen(shared.REAL_TIME_FACTOR, self._on_real_time_factor)
        self.listen(shared.SIMULATION_STATE, self._on_simulation_state)
        status = shared.NODE_STATUS
        self.create_subscription(status.type, status.name, self._on_status, LISTENING)

    @property
    def missing(self) -> dict[str, str]:
        """Nodes of the cell that are not ready, each with the reason in words."""
        found = {}
        for peer in self._peers:
            status = self._statuses.get(peer)
            if status is None or not self.count_publishers(alive_topic(peer)):
                found[peer] = "not up"
            elif status.state in (NodeStatus.STARTING, NodeStatus.WAITING):
                found[peer] = status.waits_for or "starting"
        return found

    def pursue(self) -> None:
        """Take the next step towards the goal: to be called again and again.

        Raises:
            PackError: another goal is in progress, the cell cannot be reset, or the goal was refused.
        """
        if not self._is_complete and not self.missing:
            self._is_complete = True
            self._begin()
        if self._failure:
            raise PackError(self._failure)
        if not self._is_sent and time.monotonic() >= self._send_time and self._client.server_is_ready():
            self._is_sent = True
            future = self._client.send_goal_async(self._goal, feedback_callback=self._on_feedback)
            future.add_done_callback(self._on_answer)
        if self._is_cancel_wanted and self.is_accepted:
            self._is_cancel_wanted = False
            self._handle.cancel_goal_async()
        if self.result is not None and self.result.message.startswith(REFUSED):
            raise PackError(f"the goal was {self.result.message}")

    def cancel(self) -> None:
        """Have the goal ended as soon as it has been accepted; its result comes as of any goal."""
        self._is_cancel_wanted = True

    def _begin(self) -> None:
        if self._reset is None or self._reset_client is None:
            self._send_time = time.monotonic() + SETTLE
            return
        # A reset would pull the scene away from under a goal in progress.
        if busy := [name for name, status in self._statuses.items() if status.state == NodeStatus.BUSY]:
            raise PackError(f"node '{busy[0]}' pursues a goal: wait for it, or cancel it where it was sent")
        # Not the executor's own wait: this is called between its turns.
        if not self._reset_client.wait_for_service(SETTLE):
            raise PackError(
                f"no service {self._reset[0].name}, which puts the cell into the goal's scene: no simulator? "
                "Use --no-reset for the scene as it stands"
            )
        self._reset_client.call_async(self._reset[1]).add_done_callback(self._on_reset)

    def _on_reset(self, future: Future) -> None:
        answer = future.result()
        if answer.success:
            self._send_time = time.monotonic() + SETTLE
        else:
            self._failure = f"the cell cannot be put into the goal's scene: {answer.message}"

    def _on_status(self, status: NodeStatus) -> None:
        self._statuses[status.name] = status

    def _on_answer(self, future: Future) -> None:
        self._handle = future.result()
        self.is_accepted = self._handle.accepted
        if self.is_accepted:
            self._handle.get_result_async().add_done_callback(self._on_result)
        else:
            self._failure = "the goal was rejected; the log of the node that takes it says why"

    def _on_feedback(self, message: Any) -> None:
        self.feedback = message.feedback
        if hasattr(message.feedback, "iteration_ms"):
            self.iterations_ms.append(message.feedback.iteration_ms)

    def _on_result(self, future: Future) -> None:
        self.result = future.result().result

    def _on_real_time_factor(self, message: Any) -> None:
        self.real_time_factor = message.data
        if self.is_accepted and self.result is None:
            self.factors.append(message.data)

    def _on_simulation_state(self, message: SimulationState) -> None:
        self.is_paused = message.state == SimulationState.STATE_PAUSED
