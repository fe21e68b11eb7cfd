"""Listens to a running cell from outside, and sends it goals."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Self

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from pack_interfaces.msg import GripperState, JawState, NodeStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState

from pack_bringup.job import CellGoal
from pack_bringup.robustness.arm_record import ArmRecord
from pack_bringup.robustness.fault_cases import GRASP
from pack_bringup.ros.status_listener import StatusListener
from pack_core.errors import PackError
from pack_core.motion.topics import JOINT_STATES
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.contracts.table import wiring_of
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.stream import Stream

GRIPPER = "/gripper/state"
"""Where the gripper of each cell tells whether it holds something."""
QUEUE = 10_000
"""Joint states that may wait while the observer does something else: a gap would shift what is measured."""

START_TIMEOUT = 300.0
"""For nodes to come up [s of wall clock]; the first start compiles, for 100 s on a slow machine."""


class CellObserver(StatusListener):
    """A `StatusListener` that also hears the arm, and sends goals.

    Args:
        cell: name of the cell.
        domain: ROS domain id.

    Attributes:
        arm: what was heard of the joints.
        holds: whether the gripper holds something.
        stage: of the goal in progress, from its feedback and the fingers.
        result: of the last goal; None while one is pursued.
        diagnosed: by node, the wall clock at which its newest errors came, and their text.
        factor: real-time factor, as the simulator said last.
    """

    name, turn = "cell_observer", 0.01

    def __init__(self, cell: str, domain: int) -> None:
        super().__init__(domain)
        self._cell = cell
        self.arm = ArmRecord()
        self.holds, self.factor = False, float("nan")
        self._phase, self._is_closing = "", False
        self.result: Any = None
        self.diagnosed: list[tuple[float, str, str]] = []
        self._handle: Any = None
        self._clients: dict[str, Any] = {}

    @property
    def stage(self) -> str:
        return GRASP if self._phase == "PICK" and self._is_closing else self._phase

    def __enter__(self) -> Self:
        super().__enter__()
        hear = {GRIPPER: self._on_gripper, shared.REAL_TIME_FACTOR.name: self._on_factor}
        for contract in wiring_of(self._cell):
            if contract.name in hear:
                self.node.create_subscription(contract.type, contract.name, hear[contract.name], contract.qos)
            elif contract.name == JOINT_STATES:
                self._joints = Stream(self.node, contract, depth=QUEUE)
        return self

    def take(self) -> None:
        for sent_ns, message in self._joints.take_with_times():
            self._on_joints(message, sent_ns)

    def await_ready(self, names: Sequence[str], exit_codes: Callable[[], Mapping[str, int]] = dict) -> None:
        """Listen until all these nodes have said that they are ready.

        Args:
            names: of the nodes.
            exit_codes: how those ended that did, by name; by default none does.

        Raises:
            PackError: some have not within `START_TIMEOUT`, or have ended; it names them.
        """

        def late() -> list[str]:
            return [n for n in names if n not in self.statuses or self.statuses[n].state != NodeStatus.READY]

        self.spin_until(lambda: bool(exit_codes()) or not late(), START_TIMEOUT)
        if ended := [f"{name} ended with exit code {code}" for name, code in exit_codes().items()]:
            raise PackError(f"not ready: {', '.join(ended)}")
        if missing := late():
            raise PackError(f"not ready after {START_TIMEOUT:.0f} s: {', '.join(missing)}")

    def send(self, goal: CellGoal) -> None:
        """Put the cell into the goal's scene and send the goal.

        Raises:
            PackError: the cell does not answer, or refuses.
        """
        contract, request = goal.reset()
        client = self._client(Node.create_client, contract)
        if not self.spin_until(client.service_is_ready, 20.0):
            raise PackError(f"no service {contract.name}")
        answer = client.call_async(request)
        if not self.spin_until(answer.done, 20.0) or not answer.result().success:
            raise PackError(f"{contract.name} failed: {answer.result() and answer.result().message}")
        action, message = goal.goal()
        self.result, self._phase = None, ""
        actions = self._client(ActionClient, action)
        if not self.spin_until(actions.server_is_ready, 20.0):
            raise PackError(f"no action {action.name}")
        sent = actions.send_goal_async(message, feedback_callback=self._on_feedback)
        if not self.spin_until(sent.done, 20.0):
            raise PackError("the goal was not answered")
        self._handle = sent.result()
        if not self._handle.accepted:
            raise PackError(f"the goal was not taken by {action.name}")
        self._handle.get_result_async().add_done_callback(partial(self._on_result, self._handle))

    def _client(self, make: Callable[..., Any], contract: Contract) -> Any:
        """The client of a service or an action. It is made once: all nodes remember every one that came."""
        if contract.name not in self._clients:
            self._clients[contract.name] = make(self.node, contract.type, contract.name)
        return self._clients[contract.name]

    def cancel(self) -> None:
        """Have the goal in progress end."""
        if self._handle is not None and self.result is None:
            self._handle.cancel_goal_async()

    def forget(self) -> None:
        """Await no result any more: the node that would give it has ended."""
        self._handle = None

    def silences_of(self, name: str, since: float) -> list[tuple[float, str]]:
        """When [s of wall clock after `since`] and by whom a node was called silent."""
        return [(at - since, by) for at, by, text in self.diagnosed if at >= since and f"'{name}'" in text]

    def _on_joints(self, message: JointState, sent_ns: int) -> None:
        self.arm.add(from_stamp(message.header.stamp), sent_ns, max(abs(v) for v in message.velocity))

    def _on_gripper(self, message: GripperState | JawState) -> None:
        if isinstance(message, JawState):
            self.holds = message.status == JawState.HOLDING
            self._is_closing = message.status == JawState.MOVING and message.force > 0.0
        else:
            self.holds = bool(message.is_closed)

    def _on_health(self, message: DiagnosticArray) -> None:
        super()._on_health(message)
        now = time.monotonic()
        for status in message.status:
            if status.level == DiagnosticStatus.ERROR:
                self.diagnosed.append((now, status.name, status.message))

    def _on_factor(self, message: Any) -> None:
        self.factor = message.data

    def _on_feedback(self, message: Any) -> None:
        feedback = message.feedback
        self._phase = next(
            getattr(feedback, field) for field in ("stage", "state", "phase") if hasattr(feedback, field)
        )

    def _on_result(self, handle: Any, future: Any) -> None:
        if handle is self._handle:  # else it is of a goal that was given up
            self.result = future.result().result
