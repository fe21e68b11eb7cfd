"""A node whose goals last until they are told to end, and what a test asks of it."""

from __future__ import annotations

from typing import Any

from action_msgs.msg import GoalStatus
from pack_interfaces.action import Palletize

from integration.harness import Graph
from pack_core.errors import PackError
from pack_core.ros.contracts.contract import Contract, Kind
from pack_core.ros.goal_node import GoalNode

ACTION = Contract("/wait", Palletize, ("user",), ("waiter",), "wait until told", kind=Kind.ACTION)
FAULT_TIME = 0.3
"""Silence of the peer that ends a goal [s of wall clock]."""


class Waiter(GoalNode):
    """Pursues a goal until the test ends it; an order `refuse...` is refused, `raise` is an error."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("waiter", **kwargs)
        self.result = Palletize.Result(success=True)
        self.started = self.gave_up = 0
        self.is_broken = False
        self.create_timer(0.01, self._turn, clock=self.wall)
        self.take_goals(ACTION, ["sim"], FAULT_TIME)

    def refusal(self, request: Palletize.Goal) -> str:
        if request.order == "refuse by error":
            raise PackError("it cannot be read")
        return "not today" if request.order == "refuse" else ""

    async def pursue(self, request: Palletize.Goal) -> Palletize.Result:
        self.started += 1
        if request.order == "raise":
            raise PackError("it cannot be built")
        if request.order == "fail":
            raise ZeroDivisionError
        self.publish_feedback(Palletize.Feedback(state="started"))
        await self.until_goal_ends()
        return self.result

    def on_lost_peers(self, peers: list[str]) -> None:
        self.end(False, f"lost: {', '.join(peers)}")

    def on_arm_stop(self, reason: str) -> None:
        self.end(False, reason)

    def give_up(self) -> None:
        self.gave_up += 1

    def end(self, success: bool, message: str) -> None:
        self.result = Palletize.Result(success=success, message=message)
        self.end_goal()

    def _turn(self) -> None:
        if self.is_broken:
            raise ValueError("broken")
        if self.is_cancel_requested:
            self.end(False, "stopped on request")


def send(graph: Graph, order: str = "", **kwargs: Any) -> Any:
    return graph.send_goal(ACTION, Palletize.Goal(order=order), **kwargs)


def refusal(graph: Graph) -> str:
    return graph.refusal(ACTION, Palletize.Goal())


def ended(graph: Graph, handle: Any) -> tuple[int, str]:
    """The status and the message with which a goal ends."""
    result = graph.result_of(handle)
    graph.wait_until(lambda: handle.status > GoalStatus.STATUS_CANCELING)
    return handle.status, str(result.message)
