"""What stands in the cell during a shift, and where it goes: to pallets, table B or the reject table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.palletizing.cell import REJECT_TABLE, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.item_list import Item, order_box
from pack_core.palletizing.orders.layout_plan import Insertion, PlannedBox
from pack_core.palletizing.orders.next_place import PlaceAnswer, StandingPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array
from pallet_fsm.intake import Arrival
from pallet_fsm.order_book import OrderBook, WorkItem
from pallet_fsm.report import BoxOutcome

STRAIGHT_DOWN = Insertion("Center", np.zeros(3), 0.0)
DENSITY = 300.0
"""Of what is in a box whose weight nobody knows [kg/m^3]."""
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
        self.book = OrderBook("shift", self.work, self._cell)
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
            _as_it_stands(work, self._cell)
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
        """Have a box set aside, its long side along y, in which table B has more room."""
        d_x, d_y, d_z = sorted(item.size, reverse=True)
        across = d_y, d_x, d_z
        plan = self._on_table(item, REORIENTATION_TABLE, self.free_buffers[0], across)
        return self._add(item, plan, REORIENTATION_TABLE)

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


def _as_it_stands(work: WorkItem, cell: PalletizingCell) -> PlacedBox:
    """A box on a pallet: where it was let go, at the height of its place."""
    placed = work.plan.placed
    if work.outcome is not BoxOutcome.PLACED or work.X_WB is None:
        return placed
    shift = cell.deck(work.deck).X_WD.inverse().apply(work.X_WB.p) - placed.centre
    return placed.moved([shift[0], shift[1], 0.0])
