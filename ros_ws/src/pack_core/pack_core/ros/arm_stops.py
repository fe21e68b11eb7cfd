"""What a node that pursues goals knows of stops of the arm, and how a new goal releases the arm."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.msg import ArmState

from pack_core.errors import PackError
from pack_core.ros.awaited_answer import ONCE, ServiceAnswers
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import shared


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
            await self._answers.of(self._resume, shared.RESUME_ARM.type.Request(), ONCE)
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
