"""A goal of `/palletize`: the order that it asks for, the machine that builds it, and what is reported."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from pack_interfaces.action import Palletize
from pack_interfaces.msg import PalletState

from pack_core.errors import OrderError
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order, parse_order
from pack_core.palletizing.ports import Command, PalletObservation
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.node import CellNode
from pack_core.rotations import Array, Pose
from pallet_fsm.machine import Visit
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.report import BoxOutcome, OrderReport
from pallet_fsm.states import profile_of


def requested_order(goal: Palletize.Goal, cell: PalletizingCell) -> Order:
    """The order of a goal.

    Raises:
        OrderError: the goal has no order, or the cell cannot build it; the text names every problem.
    """
    if goal.order:
        return parse_order(goal.order, "the order of the goal", cell=cell)
    if not goal.file:
        raise OrderError("the goal holds no order; give `order` or `file`")
    return load_order(Path(goal.file), cell)


def requested_config(goal: Palletize.Goal, config: PalletizerConfig) -> PalletizerConfig:
    """The node's parameters with the goal's profile; raises ConfigError where there is no such profile."""
    profile = goal.profile or config.profile
    profile_of(profile)
    return config.model_copy(update={"profile": profile})


def to_state(visit: Visit) -> PalletState:
    """The message about a state that was entered."""
    event = visit.event.value if visit.event else ""
    message = PalletState(
        state=visit.state.label, box=visit.box, place=visit.place, event=event, reason=visit.reason
    )
    message.header.stamp = to_stamp(visit.time)
    return message


def to_feedback(session: Palletizer, elapsed: float) -> Palletize.Feedback:
    """The action feedback: present state, box, and number of placed boxes."""
    report = session.report()
    return Palletize.Feedback(
        state=session.machine.state.label, box=session.machine.visits[-1].box, placed=_placed(report),
        boxes=len(report.boxes), elapsed=elapsed,
    )  # fmt: skip


def to_result(report: OrderReport, elapsed: float) -> Palletize.Result:
    """The action result of an order that has ended."""
    return Palletize.Result(
        success=report.is_complete, message=message_of(report), placed=_placed(report),
        boxes=len(report.boxes), execution_time=elapsed, report=json.dumps(report.to_json()),
    )  # fmt: skip


def message_of(report: OrderReport) -> str:
    """Why not every box was placed; empty if every one was."""
    left_out = [f"box {box.name}: {box.reason}" for box in report.boxes if box.reason]
    return "; ".join(dict.fromkeys([text for text in (report.reason, *left_out) if text]))


def _placed(report: OrderReport) -> int:
    return sum(box.outcome is BoxOutcome.PLACED for box in report.boxes)


class StatePublisher:
    """Publishes states, and logs and counts those that have a reason, which are faults.

    Args:
        node: the node that publishes.
    """

    def __init__(self, node: CellNode) -> None:
        self._node, self._publisher = node, node.advertise(contracts.PALLET_STATE)

    def publish(self, state: PalletState) -> None:
        """Publish a state that was entered."""
        self._publisher.publish(state)
        if state.reason:
            self._node.health.count(state.state, state.reason)
            self._node.get_logger().warning(f"{state.state}, box {state.box}: {state.reason}")


class OrderRun:
    """Steps the machine from its first state to its last.

    Args:
        node: the node that has the goal.
        session: the order in progress.
        apply: carries out a command.
        states: publishes the states.
    """

    def __init__(
        self, node: GoalNode, session: Palletizer, apply: Callable[[Command], None], states: StatePublisher
    ) -> None:
        self._node, self._apply, self._states = node, apply, states
        self.session = session
        self._start, self._published = session.machine.since, 0

    @property
    def elapsed(self) -> float:
        """Time from the start to the last change of state [s]."""
        return self.session.machine.since - self._start

    def halt(self, reason: str) -> None:
        """Stop safely at the next step."""
        self.session.halt(reason)

    def step(self, seen: PalletObservation) -> None:
        """Step the machine once; does nothing after its end."""
        if self.session.machine.is_over:
            return
        if self._node.is_cancel_requested:
            self.session.halt("canceled on request")
        for command in self.session.step(seen):
            self._apply(command)
        self._publish()
        if self.session.machine.is_over:
            self._node.end_goal()

    def _publish(self) -> None:
        visits = self.session.machine.visits
        for visit in visits[self._published :]:
            self._states.publish(to_state(visit))
        if len(visits) > self._published:
            self._node.publish_feedback(to_feedback(self.session, self.elapsed))
        self._published = len(visits)


def places(plan: LayoutPlan, cell: PalletizingCell) -> dict[str, tuple[Array, Pose]]:
    """Extents along the pallet's axes `(3,)` [m] and X_WG, the pose of the middle, by the box's name."""
    X_WP = cell.pallet.X_WP
    boxes = (planned.placed for planned in plan.boxes)
    return {box.id: (box.size, X_WP @ Pose(box.centre)) for box in boxes}
