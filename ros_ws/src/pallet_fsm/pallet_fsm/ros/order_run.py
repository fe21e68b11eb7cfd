"""Runs the machine for one order, and publishes its states and feedback."""

from __future__ import annotations

from collections.abc import Callable

from pack_core.palletizing.ports import Command, PalletObservation
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.node import CellNode
from pallet_fsm.machine import Visit
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.ros.results import to_feedback, to_state


class StateTeller:
    """Publishes states, and logs and counts those that have a reason, which are faults.

    Args:
        node: the node that publishes.
    """

    def __init__(self, node: CellNode) -> None:
        self._node, self._publisher = node, node.advertise(contracts.PALLET_STATE)

    def tell(self, visit: Visit) -> None:
        """Publish a state that was entered."""
        self._publisher.publish(to_state(visit))
        if visit.reason:
            self._node.health.count(visit.state.label, visit.reason)
            self._node.get_logger().warning(f"{visit.state.label}, box {visit.box}: {visit.reason}")


class OrderRun:
    """Steps the machine from its first state to its last.

    Args:
        node: the node that has the goal.
        session: the order in progress.
        apply: carries out a command.
        teller: publishes the states.
    """

    def __init__(
        self, node: GoalNode, session: Palletizer, apply: Callable[[Command], None], teller: StateTeller
    ) -> None:
        self._node, self._apply, self._teller = node, apply, teller
        self.session = session
        self._start, self._told = session.machine.since, 0

    @property
    def elapsed(self) -> float:
        """Time from the start to the last change of state [s]."""
        return self.session.machine.since - self._start

    def step(self, seen: PalletObservation) -> None:
        """Step the machine once; does nothing after its end."""
        if self.session.machine.is_over:
            return
        if self._node.is_cancel_requested:
            self.session.halt("canceled on request")
        for command in self.session.step(seen):
            self._apply(command)
        self._tell()
        if self.session.machine.is_over:
            self._node.end_goal()

    def _tell(self) -> None:
        visits = self.session.machine.visits
        for visit in visits[self._told :]:
            self._teller.tell(visit)
        if len(visits) > self._told:
            self._node.publish_feedback(to_feedback(self.session, self.elapsed))
        self._told = len(visits)
