"""What stands in the cell during a shift, and where it goes: to pallets, table B or the reject table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.palletizing.cell import PICKING_TABLE, REJECT_TABLE, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.item_list import Item, order_box, placed_item
from pack_core.palletizing.orders.layout_plan import Insertion, PlannedBox
from pack_core.palletizing.orders.next_place import PlaceAnswer, StandingPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array
from pallet_fsm.intake import Arrival
from pallet_fsm.order_book import OrderBook, WorkItem, as_it_stands
from pallet_fsm.report import BoxOutcome

STRAIGHT_DOWN = Insertion("Center", np.zeros(3), 0.0)
DENSITY = 300.0
"""Of what is in a box whose weight nobody knows [kg/m^3]."""
SAME_EDGE = 1e-6
"""By which an edge of a box and a height may differ and are the same [m]."""
SAME_PLACE = 0.05
"""Middles that are nearer are of the same place for a box that is set aside [m]."""


class ShiftFloor:
    """The boxes of a shift that are in the cell.

    Args:
        cell: the cell's physical facts; it has what shifts need.
        standing: boxes that stand already, on pallets and on table B, with what they are.

    Attributes:
        work: the boxes as the machine knows them, in the sequence in which they are placed.
        book: the book that the machine works with; it has the same boxes.
    """

    def __init__(self, cell: PalletizingCell, standing: Sequence[tuple[WorkItem, Item]] = ()) -> None:
        self._cell = cell
        self._items = {work.name: item for work, item in standing}
        self.work: list[WorkItem] = [work for work, _ in standing]
        self.book: OrderBook | None = None

    @property
    def pending(self) -> list[WorkItem]:
        """The boxes that have a place to go to and are not there yet."""
        return [work for work in self.work if not work.is_finished]

    @property
    def buffered(self) -> tuple[Item, ...]:
        """The boxes that were set aside."""
        return tuple(self._items[work.name] for work in self._set_aside() if work.is_finished)

    @property
    def free_buffers(self) -> list[Array]:
        """Middles `(2,)` [m] of the places on table B where nothing was set aside, nor is going to be."""
        assert self._cell.shift is not None
        deck = self._cell.deck(REORIENTATION_TABLE)
        used = [deck.X_WD.apply(work.plan.placed.centre)[:2] for work in self._set_aside()]
        used += [work.X_WB.p[:2] for work in self.pending if _waits_on_table(work) and work.X_WB is not None]
        places = [np.array(place) for place in self._cell.shift.buffer]
        return [p for p in places if all(np.linalg.norm(p - other) > SAME_PLACE for other in used)]

    def begin(self) -> OrderBook:
        """A new book of all boxes."""
        self.book = OrderBook("shift", self.work, self._cell, finds_places=True)
        return self.book

    def forget(self, work: WorkItem) -> None:
        """Strike a box off that has left the cell, or that is placed anew."""
        self.work.remove(work)
        if self.book is not None:
            self.book.strike(work)

    def boxes_of(self, deck: str) -> list[WorkItem]:
        """The boxes that stand on a pallet or table, or are on their way there."""
        return [work for work in self.work if work.deck == deck]

    def standing(self, place: str) -> StandingPallet:
        """A pallet with its boxes, where they were put down, and those on their way, where they will be."""
        boxes = tuple(
            self._listed(as_it_stands(work, self._cell))
            for work in self.boxes_of(place)
            if work.outcome in (BoxOutcome.PLACED, BoxOutcome.PENDING)
        )
        decks = [work.deck for work in self.work if work.deck in self._cell.pallets]
        missed = decks[::-1].index(place) if place in decks else 0
        return StandingPallet(place, boxes, missed)

    def place(self, answer: PlaceAnswer, arrival: Arrival) -> WorkItem:
        """Have a box brought to its place on a pallet: the one that came, or one that was set aside."""
        assert answer.plan is not None
        aside = next((work for work in self._set_aside() if work.name == answer.item), None)
        if aside is None:
            assert arrival.item is not None
            return self._add(arrival.item, answer.plan, answer.pallet)
        self.forget(aside)
        work = self._add(self._items[aside.name], answer.plan, answer.pallet)
        work.source, work.X_WB = REORIENTATION_TABLE, aside.X_WB
        return work

    def set_aside(self, item: Item) -> WorkItem:
        """Have a box set aside."""
        plan = self._aside(item, self.free_buffers[0])
        return self._add(item, plan, REORIENTATION_TABLE)

    def held(self, work: WorkItem) -> Item:
        """A box in the hand, which stays upright as it hangs there: as it came, or as it was stood up."""
        item = self._items[work.name]
        height = min(item.size) if work.X_WG is not None else float(work.plan.placed.size[2])
        length, width = sorted(item.size, key=lambda edge: abs(edge - height))[1:]
        may_hang = not item.this_side_up or abs(item.size[2] - height) < SAME_EDGE
        size = (length, width, height) if may_hang else item.size
        return item.model_copy(update={"size": size, "this_side_up": True})

    def put_elsewhere(self, work: WorkItem, plan: PlannedBox, deck: str) -> None:
        """Have the box in the hand brought to another place; what was to rest on it gets another one, too."""
        for other in self.pending:
            if other is not work and other.deck == work.deck and other.plan.placed.rests_on(work.plan.placed):
                other.finish(BoxOutcome.SKIPPED, f"box {work.name} does not come to where it was to stand")
        work.box, work.plan, work.deck = order_box(self._items[work.name], plan.placed), plan, deck

    def refuge(self, work: WorkItem) -> tuple[PlannedBox, str] | None:
        """A place for the box in the hand beside the pallets: on table B, or where boxes are rejected.

        It is set aside once only, and not after it was stood up, as boxes are gripped there as they come.
        """
        item, free = self._items[work.name], self.free_buffers
        is_new = work.X_WG is not None and work.source == PICKING_TABLE
        if is_new and free and REORIENTATION_TABLE not in work.refused:
            return self._aside(item, free[0]), REORIENTATION_TABLE
        if REJECT_TABLE in work.refused:
            return None
        middle = self._cell.place(REJECT_TABLE).middle[:2]
        x, y, z = self.held(work).size
        return self._on_table(item, REJECT_TABLE, middle, (x, y, z)), REJECT_TABLE

    def decide_anew(self, work: WorkItem) -> None:
        """Strike a box off that is to get another place; on table B it is one that was set aside again."""
        self.forget(work)
        if work.source == REORIENTATION_TABLE and work.X_WB is not None:
            item = self._items[work.name]
            aside = self._add(item, self._aside(item, work.X_WB.p[:2]), REORIENTATION_TABLE)
            aside.X_WB, aside.outcome = work.X_WB, BoxOutcome.PLACED

    def _aside(self, item: Item, middle_W: Array) -> PlannedBox:
        """A place on table B, the box's long side along y, in which there is more room."""
        d_x, d_y, d_z = sorted(item.size, reverse=True)
        return self._on_table(item, REORIENTATION_TABLE, middle_W, (d_y, d_x, d_z))

    def send_away(self, arrival: Arrival) -> WorkItem:
        """Have a box put where somebody takes it away: all that is known of it is what was measured."""
        d_x, d_y, d_z = (round(float(edge), 4) for edge in arrival.dims)
        dims = d_x, d_y, d_z
        mass = DENSITY * float(np.prod(dims)) if arrival.item is None else arrival.item.weight
        item = Item(id=arrival.box, article="", size=dims, weight=mass, this_side_up=True)
        middle = self._cell.place(REJECT_TABLE).middle[:2]
        plan = self._on_table(item, REJECT_TABLE, middle, dims)
        work = self._add(item, plan, REJECT_TABLE)
        work.X_WB = arrival.X_WB
        return work

    def _set_aside(self) -> list[WorkItem]:
        return self.boxes_of(REORIENTATION_TABLE)

    def _listed(self, placed: PlacedBox) -> PlacedBox:
        """A box with what may stand on it, which neither a message of a plan nor the journal has."""
        return placed_item(self._items[placed.id], placed.lower, placed.size)

    def _on_table(self, item: Item, table: str, middle_W: Array, size: tuple[float, ...]) -> PlannedBox:
        """A place on a table with a box's middle at a point `(2,)` [m] of the world."""
        X_WD = self._cell.deck(table).X_WD
        middle = X_WD.inverse().apply(np.array([*middle_W, X_WD.p[2]]))
        lower = np.array([*(middle[:2] - 0.5 * np.array(size)[:2]), 0.0])
        return PlannedBox(PlacedBox(item.id, lower, np.array(size), item.weight), STRAIGHT_DOWN)

    def item(self, name: str) -> Item:
        """What a box is."""
        return self._items[name]

    def _add(self, item: Item, plan: PlannedBox, deck: str) -> WorkItem:
        work = WorkItem(order_box(item, plan.placed), plan, deck, has_come=True)
        self._items[item.id] = item
        self.work.append(work)
        if self.book is not None:
            self.book.add(work)
        return work


def _waits_on_table(work: WorkItem) -> bool:
    return work.source == REORIENTATION_TABLE and work.approach is None
