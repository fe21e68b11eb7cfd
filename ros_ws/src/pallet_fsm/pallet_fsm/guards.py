"""The conditions of the table of transitions, by what is known of the box in work."""

from __future__ import annotations

from pack_core.palletizing.orders.handling import Handling
from pallet_fsm.order_book import OrderBook
from pallet_fsm.states import State
from pallet_fsm.transitions import Guard


def holds(guard: Guard, state: State, book: OrderBook, tries: int) -> bool:
    """Whether a condition holds.

    Args:
        guard: the condition.
        state: the present state of the machine; for `HAS_TRIES` the fault whose tries are counted.
        book: the order's boxes.
        tries: for each kind of fault and box.
    """
    item = book.current
    has_tries = item.tries[state] < tries
    return {
        Guard.IS_UPRIGHT: item.handling is Handling.NONE,
        Guard.IS_FLIP: item.handling is Handling.FLIP,
        Guard.HAS_TRIES: has_tries,
        Guard.HAS_NO_TRIES: not has_tries,
        Guard.HAS_BOXES: book.has_boxes,
        Guard.IS_HOLDING: item.X_TB is not None,
        Guard.IS_FINISHED: item.is_finished,
        Guard.IS_ON_TABLE: item.approach is not None,
        Guard.IS_UNSEEN: item.X_WB is None and item.X_TB is None,
    }[guard]
