"""The boxes of an order or a shift, with all that is known of each: in work, the next one, those put down."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.cell import PALLET, PICKING_TABLE, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.orders.layout_plan import LayoutPlan, PlannedBox
from pack_core.palletizing.orders.order import Order, OrderBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array, Pose, to_matrix
from pallet_fsm.report import BoxOutcome, BoxReport
from pallet_fsm.states import State
from pallet_fsm.tool_poses import placed_pose


@dataclass(eq=False)
class WorkItem:
    """A box of the order and its state.

    Attributes:
        box: the box as ordered.
        plan: its place and its insertion, in the frame of the deck that it goes to.
        deck: name of the pallet or table that it goes to.
        source: name of the table on which it stands before it is gripped.
        has_come: whether it stands there already, so that nobody needs to be sent for it.
        X_WB: estimated pose where it stands; None before it was detected and while it is gripped.
        X_TB: pose in the tool's frame while it is gripped; None otherwise.
        X_WG: pose of the tool at which it was gripped on its table, as long as it can be put back there.
        approach: approach direction of the tool when it stood the box up on table B `(3,)`.
        weighed: its mass by the arm's torques after the last grip [kg]; None before it was weighed.
        outcome: what became of the box.
        reason: why it was skipped or lost; empty otherwise.
        tries: number of faults of each kind so far.
        refused: the decks on which it had a place to which there was no way.
    """

    box: OrderBox
    plan: PlannedBox
    deck: str = PALLET
    source: str = PICKING_TABLE
    has_come: bool = False
    X_WB: Pose | None = None
    X_TB: Pose | None = None
    X_WG: Pose | None = None
    approach: Array | None = None
    weighed: float | None = None
    outcome: BoxOutcome = BoxOutcome.PENDING
    reason: str = ""
    tries: Counter[State] = field(default_factory=Counter)
    refused: set[str] = field(default_factory=set)
    _carried: CarriedBox | None = field(default=None, init=False)

    @property
    def name(self) -> str:
        """Name of the box."""
        return self.box.id

    @property
    def dims(self) -> Array:
        """Edges as it arrives `(3,)` [m]."""
        return np.array(self.box.dims)

    @property
    def handling(self) -> Handling:
        """How the box must be turned on its way."""
        return self.box.turn.handling

    @property
    def is_finished(self) -> bool:
        """Whether the box was placed, skipped or lost."""
        return self.outcome is not BoxOutcome.PENDING

    def finish(self, outcome: BoxOutcome, reason: str = "") -> None:
        """Note what became of the box; nothing more is done for it."""
        self.outcome, self.reason = outcome, reason

    @property
    def carried(self) -> CarriedBox | None:
        """The gripped box as the motion's collision checks need it; None while it is not gripped."""
        if self.X_TB is None:
            return None
        if self._carried is None or self._carried.X_TB is not self.X_TB:
            self._carried = CarriedBox(self.X_TB, self.dims)
        return self._carried

    def take(self, X_WT: Pose) -> None:
        """Note that the box was gripped: its estimated pose gives X_TB."""
        assert self.X_WB is not None
        self.X_TB, self.X_WB = X_WT.inverse() @ self.X_WB, None

    def let_go(self, X_WT: Pose, drop: float) -> None:
        """Note that the box was released: it stands `drop` [m] below the pose of its release."""
        assert self.X_TB is not None
        X_WB = X_WT @ self.X_TB
        self.X_WB, self.X_TB = Pose(X_WB.p - np.array([0.0, 0.0, drop]), X_WB.q), None


BESIDE = 0.02
"""Boxes nearer to a place than this may be touched when a box is put there [m]."""


class OrderBook:
    """Work items in the sequence in which they are placed.

    Args:
        name: of the order or shift.
        items: the boxes, those that stand already before those that are to be placed.
        cell: the cell's physical facts.
        finds_places: whether places are decided while the book is worked on: a box in the hand to whose place
            there is no way gets another one, and boxes that were moved a little are known to stand elsewhere.

    Attributes:
        current: the box in work.
        others: what else stands in the cell, and is not to be placed yet.
        is_next_coming: whether the next box is about to be found: it is worth while to wait for it.
        is_placing_anew: whether another place for the box in the hand is looked for.
        relocated: boxes that were found to stand a little elsewhere, with how far, in words.
        lost: boxes that were found not to stand where they were put down.
    """

    def __init__(
        self, name: str, items: Sequence[WorkItem], cell: PalletizingCell, *, finds_places: bool = False
    ) -> None:
        self._cell, self.name, self.items, self.finds_places = cell, name, list(items), finds_places
        self._furniture = cell.furniture
        self.others: tuple[Obstacle, ...] = ()
        self.is_next_coming = self.is_placing_anew = False
        self.relocated: list[tuple[WorkItem, str]] = []
        self.lost: list[WorkItem] = []
        self.current = next((item for item in self.items if not item.is_finished), self.items[-1])

    @classmethod
    def of_order(cls, order: Order, plan: LayoutPlan, cell: PalletizingCell) -> OrderBook:
        """The book of an order whose boxes go to the places of a plan."""
        items = [WorkItem(order.box(planned.placed.id), planned) for planned in plan.boxes]
        return cls(order.order_id, items, cell)

    def add(self, item: WorkItem) -> None:
        """Take a box more, to be placed after all others."""
        self.items.append(item)

    def has(self, name: str) -> bool:
        """Whether there is a box of this name, that was not struck."""
        return any(item.name == name for item in self.items)

    def strike(self, item: WorkItem) -> None:
        """Forget a box that is not in work any more: it has left the cell, or another item stands for it."""
        self.items.remove(item)

    @property
    def upcoming(self) -> WorkItem | None:
        """The next box, once the current one is finished; None where there is none."""
        return next((item for item in self.items if not item.is_finished and item is not self.current), None)

    @property
    def has_boxes(self) -> bool:
        """Whether any box is not finished yet."""
        return any(not item.is_finished for item in self.items)

    def advance(self) -> None:
        """Make the next box the current one if the current one is finished."""
        if self.current.is_finished and self.upcoming is not None:
            self.current = self.upcoming

    def skip(self, reason: str) -> None:
        """Leave out the current box, and all boxes that would rest on it."""
        self.current.finish(BoxOutcome.SKIPPED, reason)
        self.current.X_WB = None
        for item in self.items:
            skipped = (o for o in self.items if o.outcome is BoxOutcome.SKIPPED and o.deck == item.deck)
            missing = [other.name for other in skipped if item.plan.placed.rests_on(other.plan.placed)]
            if missing and not item.is_finished:
                item.finish(BoxOutcome.SKIPPED, f"it would rest on {', '.join(missing)}, which was skipped")

    def obstacles(self) -> tuple[Obstacle, ...]:
        """The furniture, every box whose pose is known, and what else stands in the cell."""
        boxes = (standing_box(item.box, item.X_WB) for item in self.items if item.X_WB is not None)
        return (*self._furniture, *boxes, *self.others)

    def standing_on(self, deck: str) -> tuple[Obstacle, ...]:
        """The boxes that were put down on a pallet or table, and those that wait there to be gripped."""
        found = [
            item
            for item in self.items
            if (item.deck == deck and item.outcome is BoxOutcome.PLACED)
            or (item.source == deck and not item.is_finished)
        ]
        if deck == REORIENTATION_TABLE and self.is_on_table and self.current not in found:
            found.append(self.current)
        return tuple(standing_box(item.box, item.X_WB) for item in found if item.X_WB is not None)

    @property
    def is_on_table(self) -> bool:
        """Whether the box in work stands on table B, to be gripped again."""
        item = self.current
        return item.approach is not None and item.X_WB is not None and not item.is_finished

    def lose(self, name: str, reason: str) -> None:
        """Note that a box which was placed no longer stands in its place."""
        item = next(item for item in self.items if item.name == name)
        item.finish(BoxOutcome.LOST, reason)
        self.lost.append(item)

    def relocate(self, name: str, moved: Callable[[Pose], Pose], reason: str) -> None:
        """Note that a box that was placed stands a little elsewhere: at `moved` of where it stood."""
        item = next(item for item in self.items if item.name == name)
        assert item.X_WB is not None
        item.X_WB = moved(item.X_WB)
        item.plan = replace(item.plan, placed=as_it_stands(item, self._cell))
        self.relocated.append((item, reason))

    def is_beside(self, name: str, shift_W: Array) -> bool:
        """Whether a box that was moved by `shift_W` `(2,)` [m] is, or was, next to the current one's place.

        That one is on its way there, and its place was chosen beside where the other stood.
        """
        other = next(item for item in self.items if item.name == name)
        if self.current.is_finished or self.current.deck != other.deck:
            return False
        R_WD = to_matrix(self._cell.deck(other.deck).X_WD.q)
        placed = other.plan.placed
        after = placed.moved([*shift_W, 0.0] @ R_WD)
        return bool(neighbours(self.current.plan.placed, {"before": placed, "after": after}))

    def beside(self, item: WorkItem) -> frozenset[str]:
        """Names of the obstacles that a box touches, or nearly touches, at its place."""
        placed = {
            other.name: other.plan.placed
            for other in self.items
            if other.X_WB is not None and other.deck == item.deck
        }
        return neighbours(item.plan.placed, placed) | {item.deck}

    def reports(self) -> tuple[BoxReport, ...]:
        """What became of each box."""
        return tuple(
            BoxReport(
                item.name, item.box.dims, item.box.weight, item.weighed, item.handling.value, item.outcome,
                item.reason,
                item.plan.insertion.direction,
                placed_pose(item.plan.placed, item.box, self._cell.deck(item.deck).X_WD, item.X_WB),
            )
            for item in self.items
        )  # fmt: skip


def standing_box(box: OrderBox, X_WB: Pose) -> Obstacle:
    """The obstacle of a box that stands at X_WB."""
    return Obstacle(box.id, X_WB, np.array(box.dims))


def as_it_stands(work: WorkItem, cell: PalletizingCell) -> PlacedBox:
    """A box that was put down on a pallet or table: where it was let go, at the height of its place."""
    placed = work.plan.placed
    if work.outcome is not BoxOutcome.PLACED or work.X_WB is None:
        return placed
    shift = cell.deck(work.deck).X_WD.inverse().apply(work.X_WB.p) - placed.centre
    return placed.moved([shift[0], shift[1], 0.0])


def neighbours(placed: PlacedBox, others: Mapping[str, PlacedBox]) -> frozenset[str]:
    """Names of the boxes that are next to a place, over it or under it."""
    near = {name for name, other in others.items() if np.all(placed.clearance(other) < BESIDE)}
    return frozenset(near - {placed.id})
