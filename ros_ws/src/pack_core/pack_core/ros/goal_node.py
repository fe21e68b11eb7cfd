"""Base of the nodes that pursue an action's goals, one at a time."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from pack_interfaces.msg import ArmState
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future

from pack_core.errors import PackError
from pack_core.ros.awaited_answer import ONCE, ServiceAnswers
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.contracts.shared import CLOCK
from pack_core.ros.node import CellNode
from pack_core.ros.watch.peer_watch import SilentPeers

REFUSED = "refused: "
"""How the message of a goal's result begins when the goal was not taken; the reason follows."""
CHECK_PERIOD = 0.1
"""Time between two checks, during a goal, of how long peers have been silent [s of wall clock]."""


class GoalNode(CellNode, ABC):
    """Takes a goal when it has none, refuses others with the reason, and ends each with one result.

    A goal goes through these steps:

    1. It is refused while another goal is in progress or a watched peer is silent, or with the reason that
       the subclass gives (`refusal`): it ends at once, aborted, with a result whose message is `refused: `
       and the reason, which is logged and counted in /diagnostics, too.
    2. `pursue` works on it, usually until `end_goal` is called, and returns the action's result, which must
       have the fields `success` and `message`. A PackError becomes the message of one without success.
    3. A client that wants it cancelled sets `is_cancel_requested`, which the subclass looks at in every
       turn of its work: it alone knows how to stop safely.
    4. While a watched peer has been silent for longer than `fault_time`, `on_lost_peers` is called.
    5. When the arm is stopped (`/arm/stop`), `on_arm_stop` is called once. The next goal releases the arm.
    6. When a callback fails unforeseen, or a second simulator comes, the goal ends with it (`give_up`).
    """

    def __init__(self, name: str, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self.silent_peers = SilentPeers()
        self._actions: list[ActionServer] = []
        self._goal: ServerGoalHandle | None = None
        self._goal_ended: Future | None = None
        self.answers = ServiceAnswers(self)
        self._failure = ""

    def take_goals(
        self, contract: Contract, watched: Iterable[str], fault_time: float, *others: Contract
    ) -> None:
        """Open the action; the last thing that a subclass's constructor does.

        Args:
            contract: the action.
            watched: nodes that a goal needs.
            fault_time: silence of one of them that ends a goal [s of wall clock].
            others: further actions; of all of them, one goal at a time is taken, and `refusal` and `pursue`
                tell them apart by the type of the request.
        """
        self._fault_time = fault_time
        self._actions = [
            ActionServer(
                self, action.type, self.in_cell(action.name), partial(self._execute, action.type.Result),
                goal_callback=self._on_goal, cancel_callback=lambda _: CancelResponse.ACCEPT,
            )
            for action in (contract, *others)
        ]  # fmt: skip
        self._arm_stops = ArmStops(self, self.on_arm_stop, self.answers)
        self.watch(watched, self.on_peer)
        self._checks = self.create_timer(CHECK_PERIOD, self._check_peers, clock=self.wall, autostart=False)

    def destroy_node(self) -> None:
        """Take no more goals, then end."""
        for action in self._actions:
            action.destroy()
        super().destroy_node()

    @property
    def is_busy(self) -> bool:
        return self._goal is not None

    @property
    def is_cancel_requested(self) -> bool:
        """Whether the client wants the goal in progress to end."""
        return (goal := self._goal) is not None and goal.is_cancel_requested

    def publish_feedback(self, feedback: Any) -> None:
        """Tell the client of the goal in progress where it stands; may be called from any thread."""
        if (goal := self._goal) is not None:
            goal.publish_feedback(feedback)

    async def until_goal_ends(self) -> None:
        """Wait, within `pursue`, until `end_goal` is called."""
        assert self._goal_ended is not None, "only for `pursue`"
        await self._goal_ended
        if self._failure:
            raise PackError(self._failure)

    def end_goal(self) -> None:
        """Let `until_goal_ends` return; may be called from any thread, and more than once."""
        if self._goal_ended is not None and not self._goal_ended.done():
            self._goal_ended.set_result(None)

    def refusal(self, request: Any) -> str:
        """Why this goal cannot be taken now, in words; empty when it can.

        Raises:
            PackError: it cannot; the error's text is the reason.
        """
        return ""

    @abstractmethod
    async def pursue(self, request: Any) -> Any:
        """Work on an accepted goal and return the action's result."""

    @abstractmethod
    def on_lost_peers(self, peers: list[str]) -> None:
        """End the goal in progress: these peers have been silent for longer than `fault_time`."""

    @abstractmethod
    def on_arm_stop(self, reason: str) -> None:
        """End the goal in progress: the arm was stopped, and its driver refuses setpoints."""

    @abstractmethod
    def give_up(self) -> None:
        """Forget the goal in progress and have the arm brake; the core is not asked, as it may be broken."""

    def on_failure(self, reason: str) -> None:
        """End the goal in progress with the reason."""
        if self._goal is not None and not self._failure:
            self._failure = reason
            self.answers.give_up(reason)
            self.end_goal()
            self.give_up()

    def on_peer(self, peer: str, is_alive: bool) -> None:
        """A watched peer fell silent or was heard of again; called from the executor or another thread."""
        self.silent_peers.note(peer, is_alive, time.monotonic())

    def describe(self, result: Any) -> str:
        """A result in a line of the log."""
        return str(result.message)

    def _on_goal(self, _: Any) -> GoalResponse:
        self._arm_stops.expect_goal()
        return GoalResponse.ACCEPT  # every goal: a refused one is told the reason in its result

    def _reason_to_refuse(self, request: Any) -> str:
        if self._goal is not None:
            return "a goal is in progress; cancel it first"
        if self.silent_peers:
            return f"silent: {self.silent_peers}"
        try:
            return self.health.faults.get(CLOCK.name) or self.refusal(request)
        except PackError as error:
            return str(error)

    def _refuse(self, result_type: type[Any], goal: ServerGoalHandle, reason: str) -> Any:
        self.health.count("refused goal", reason)
        self.get_logger().warning(f"refused goal: {reason}")
        goal.abort()
        return refused_result(result_type, reason)

    async def _execute(self, result_type: type[Any], goal: ServerGoalHandle) -> Any:
        # The executor runs this up to its first `await` without a break, so that of two goals one is taken.
        if reason := self._reason_to_refuse(goal.request):
            return self._refuse(result_type, goal, reason)
        self._goal, self._goal_ended, self._failure = goal, Future(executor=self.executor), ""
        self.tell_status()
        self._checks.reset()
        try:
            await self._arm_stops.release()
            result = await self.pursue(goal.request)
        except PackError as error:
            result = result_type(success=False, message=str(error))
        except Exception as error:
            self.fail("goal", error)
            result = result_type(success=False, message=f"the node failed: {error!r}; its log says more")
        finally:
            self._goal = None
        self._checks.cancel()  # not in `finally`, which runs, too, when the node is gone before its goal
        self.tell_status()
        self.get_logger().info(f"goal ended: {self.describe(result)}")
        if result.success:
            goal.succeed()
        elif goal.is_cancel_requested:
            goal.canceled()
        else:
            goal.abort()
        return result

    def _check_peers(self) -> None:
        lost = self.silent_peers.lasting(self._fault_time, time.monotonic())
        if lost:
            self.on_lost_peers(lost)
        self.answers.check(time.monotonic(), is_cancelled=self.is_cancel_requested)


class ArmStops:
    """Ends a goal in progress when the arm is stopped, and has a stopped arm released for a later goal.

    Stops are counted, because of a stop and its release only the second message may come.

    Args:
        node: pursues the goals.
        on_stop: ends the goal in progress; is called once for a stop, with the reason in words.
        answers: of services, as the node waits for them.
    """

    def __init__(self, node: CellNode, on_stop: Callable[[str], None], answers: ServiceAnswers) -> None:
        self._node, self._on_stop, self._answers = node, on_stop, answers
        self._arm = ArmState()
        self._stops_known = 0
        self._resume = node.create_client(shared.RESUME_ARM.type, shared.RESUME_ARM.name)
        node.listen(shared.ARM_STATE, self._on_state)

    def expect_goal(self) -> None:
        """A goal has come: it may release an arm that was stopped before, but not one stopped from now on."""
        self._stops_known = self._arm.stops

    async def release(self) -> None:
        """Have the driver follow setpoints again, if it was stopped before the goal came.

        Raises:
            PackError: it was stopped since, which the goal must not undo, or the driver does not answer.
        """
        if not self._arm.is_stopped:
            return
        known = self._stops_known  # when the goal came
        if self._arm.stops == known:
            # Never a second time: it could release the arm from a stop that came in between.
            answer = await self._answers.of(self._resume, shared.RESUME_ARM.type.Request(), ONCE)
            if not answer.success and self._arm.is_stopped:
                raise PackError(f"{_stopped(self._arm.reason)}, and was not released: {answer.message}")
        if self._arm.stops != known:
            raise PackError(_stopped(self._arm.reason))

    def _on_state(self, message: ArmState) -> None:
        self._arm = message
        is_new = message.stops > self._stops_known
        if self._node.is_busy or message.stops < self._stops_known:  # fewer: the driver began anew
            self._stops_known = message.stops
        if self._node.is_busy and is_new:
            self._on_stop(_stopped(message.reason))


def _stopped(reason: str) -> str:
    return f"the arm was stopped: {reason or 'and released at once'}"


def refused_result(kind: type[Any], reason: str) -> Any:
    """The result, of an action's result type, of a goal that is not taken for this reason."""
    result = kind(success=False, message=REFUSED + reason)
    if hasattr(result, "exit_reason"):
        result.exit_reason = "refused"
    return result
