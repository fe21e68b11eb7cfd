"""Sends goals to a running cell: the cell is put into the goal's scene, the goal sent and followed."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.task import Future

from pack_core.errors import PackError
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.goal_node import REFUSED
from pack_core.ros.node import CellNode
from pack_core.tasks.steps import Steps, TaskRun, ask, wait

SETTLE = 1.0
"""Wait before a goal is sent [s of wall clock], so that all nodes have heard each other, and of what a reset
has changed."""
ANSWER = 60.0
"""Longest wait for an answer [s of wall clock]; a reset builds a model, on a machine that may be busy."""
PERIOD = 0.05
"""Between two checks whether there is an answer [s of wall clock]."""
LOST = "the goal is lost"
"""How it is said that nobody pursues a goal any more that was taken; the reason follows."""


class GoalSender:
    """Sends the goals of an action, one at a time.

    It looks for answers in a timer of its node, which must be spun; `send` may be called from any thread.

    Args:
        node: who sends.
        action: where goals go.
        reset: the service that puts the cell into a goal's scene; None: the cell is taken as it stands.
        on_feedback: is called with each feedback.
        on_change: is called when a goal has been taken, has ended or has failed.
        is_ready: whether the cell is ready for a goal; after a reset perception may have to look anew.

    Attributes:
        is_sent: whether the goal is on its way, or was taken.
        is_accepted: whether the goal was taken.
        feedback: the newest, if any.
        result: once the goal has ended.
        failure: why the goal could not be sent or was refused, in words; empty while nothing went wrong.
    """

    def __init__(
        self, node: CellNode, action: Contract, reset: Contract | None = None, *,
        on_feedback: Callable[[Any], None] = lambda _: None, on_change: Callable[[], None] = lambda: None,
        is_ready: Callable[[], bool] = lambda: True,
    ) -> None:  # fmt: skip
        self._node, self._on_feedback, self._on_change = node, on_feedback, on_change
        self._is_ready = is_ready
        self._name = action.name
        self._action = ActionClient(node, action.type, node.in_cell(action.name))
        self._reset = node.create_client(reset.type, reset.name) if reset else None
        self._timer: Any = None
        self._handle: Any = None
        self._is_cancel_wanted = False
        self.is_sent = self.is_accepted = False
        self.failure = ""
        self.feedback: Any = None
        self.result: Any = None

    @property
    def is_starting(self) -> bool:
        """Whether a goal is on its way that has not been taken yet."""
        return self._timer is not None and not self.is_accepted

    def send(self, goal: Any, reset: Any = None) -> None:
        """Begin with a goal, and the request that puts the cell into its scene; an earlier one is let go."""
        self._end_timer()
        self.is_sent = self.is_accepted = self._is_cancel_wanted = False
        self.failure = ""
        self.feedback = self.result = None
        run = TaskRun(self._steps(goal, reset))
        self._timer = self._node.create_timer(PERIOD, lambda: self._go_on(run), clock=self._node.wall)

    def cancel(self) -> None:
        """Have the goal ended as soon as it has been taken; its result comes as of any goal."""
        self._is_cancel_wanted = True

    def _go_on(self, run: TaskRun[None]) -> None:
        run.go_on()
        if run.is_over:
            self.failure = run.failure
            self._end_timer()
            self._on_change()

    def _end_timer(self) -> None:
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None

    def _steps(self, goal: Any, reset: Any) -> Steps[None]:
        """All that is done for a goal; raises PackError where it does not come to its result."""
        if self._reset is not None:
            yield from self._put_into_scene(reset)
        yield from wait(lambda: False, SETTLE, time.monotonic)
        # after that the goal is sent all the same, and refused with the reason
        yield from wait(self._is_ready, ANSWER, time.monotonic)
        if not (yield from wait(self._action.server_is_ready, ANSWER, time.monotonic)):
            raise PackError(f"nobody takes goals of {self._name}")
        self.is_sent = True
        sent = self._action.send_goal_async(goal, feedback_callback=self._take_feedback)
        self._handle = yield from ask(sent, ANSWER, time.monotonic)
        if not self._handle.accepted:
            raise PackError("the goal was rejected; the log of the node that takes it says why")
        self.is_accepted = True
        self._on_change()
        yield from self._reach_end(self._handle.get_result_async())

    def _put_into_scene(self, request: Any) -> Steps[None]:
        assert self._reset is not None
        if not (yield from wait(self._reset.service_is_ready, SETTLE, time.monotonic)):
            raise PackError(
                f"no service {self._reset.srv_name}, which puts the cell into the goal's scene: "
                "no simulator? `pack goal --no-reset` takes the scene as it stands"
            )
        answer = yield from ask(self._reset.call_async(request), ANSWER, time.monotonic)
        if not answer.success:
            raise PackError(f"the cell cannot be put into the goal's scene: {answer.message}")

    def _reach_end(self, ending: Future) -> Steps[None]:
        while not ending.done():
            if self._is_cancel_wanted:
                self._is_cancel_wanted = False
                self._handle.cancel_goal_async()
            yield
        answer = ending.result()
        if answer.status == GoalStatus.STATUS_UNKNOWN:
            raise PackError(f"{LOST}: who pursued it was started anew, and knows nothing of it")
        self.result = answer.result
        if self.result.message.startswith(REFUSED):
            raise PackError(f"the goal was {self.result.message}")

    def _take_feedback(self, message: Any) -> None:
        self.feedback = message.feedback
        self._on_feedback(message.feedback)
