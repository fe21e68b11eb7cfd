"""The report of a shift, from nothing but its journal: throughput, pallets, faults, and where time went."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from pack_core.palletizing.cell import PALLETS, palletizing_cell
from pack_core.palletizing.orders.item_list import Item, order_box
from pack_core.palletizing.orders.order import Order, OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.shift_journal import SETTLED, WATCHED, EventKind, ShiftEvent, WrittenShift

HOUR = 3600.0
"""In seconds."""


def shift_report(shift: WrittenShift) -> dict[str, Any]:
    """The measures of a shift as plain values.

    `boxes_per_hour` counts boxes put down on pallets, from the first box that came to the last that was put
    down, without the time in which the shift was interrupted. `waits_s` is the time in which no box was in
    work: for a box to come and be measured, or for an empty pallet. `state_s` is the time in each state, a
    box on a pallet. `unwanted_contacts` and `fallen` are there only if a simulator watched for them.
    """
    events = shift.events
    put_down = [event for event in events if event.kind is EventKind.PUT_DOWN]
    on_pallets = [event for event in put_down if event.place in PALLETS]
    came = [event for event in events if event.kind is EventKind.CAME]
    decided = [event for event in events if event.kind is EventKind.DECIDED]
    steps = Counter(event.data["step"] for event in decided)
    duration = _duration(events, came[0].time, put_down[-1].time) if put_down and came else 0.0
    states, waits = _times(events)
    handling = Counter(event.data["handling"] for event in on_pallets)
    return {
        "seed": shift.facts.get("seed"),
        "reason": _reason(events),
        "duration_s": duration,
        "came": len({event.box for event in came}),
        "settled": len({event.box for event in events if event.kind in SETTLED}),
        "on_pallets": len(on_pallets),
        "boxes_per_hour": HOUR * len(on_pallets) / duration if duration else None,
        "set_aside": steps["set aside"],
        "rejected": {event.box: event.reason for event in decided if event.data["step"] == "reject"},
        "moved": {event.box: event.reason for event in events if event.kind is EventKind.MOVED},
        "skipped": {event.box: event.reason for event in events if event.kind is EventKind.SKIPPED},
        "lost": {event.box: event.reason for event in events if event.kind is EventKind.LOST},
        **(_watched(events) if shift.facts.get(WATCHED) else {}),
        "faults": dict(_faults(events)),
        "handling": dict(handling),
        "over_table_share": handling["table"] / len(on_pallets) if on_pallets else None,
        "utilisation": 1.0 - sum(waits.values()) / duration if duration else None,
        "waits_s": dict(waits),
        "state_s": {state: float(np.sum(times)) / max(1, len(on_pallets)) for state, times in states.items()},
        "pallets": [_pallet(pallet) for pallet in built_pallets(events)],
    }


def _duration(events: Sequence[ShiftEvent], start: float, end: float) -> float:
    """Time from `start` to `end` [s] without interruptions: from an event to a later beginning."""
    during = [event for event in events if start <= event.time <= end]
    gaps = (now.time - before.time for before, now in pairwise(during) if now.kind is EventKind.BEGAN)
    return end - start - sum(gaps)


def _reason(events: Sequence[ShiftEvent]) -> str:
    """Why the shift ended; one that ended and was gone on with has not."""
    ends = [event for event in events if event.kind in (EventKind.BEGAN, EventKind.ENDED)]
    return ends[-1].reason if ends and ends[-1].kind is EventKind.ENDED else "it goes on"


@dataclass(frozen=True)
class BuiltPallet:
    """A pallet as it was built: its place, its boxes, and when it was taken away [s]; None: it stands."""

    place: str
    boxes: tuple[ShiftEvent, ...]
    taken: float | None


def built_pallets(events: Sequence[ShiftEvent]) -> list[BuiltPallet]:
    """Every pallet of a shift on which something was put down, in the sequence in which they were taken."""
    found, standing = list[BuiltPallet](), dict[str, list[ShiftEvent]]()
    for event in events:
        if event.kind is EventKind.PUT_DOWN and event.place in PALLETS:
            standing.setdefault(event.place, []).append(event)
        elif event.kind is EventKind.TAKEN and event.place in PALLETS:
            boxes = tuple(standing.pop(event.place, []))
            found.append(BuiltPallet(event.place, boxes, event.time))
    return [*found, *(BuiltPallet(place, tuple(boxes), None) for place, boxes in standing.items())]


def order_of_pallet(pallet: BuiltPallet, name: str) -> Order:
    """A pallet as an order, to be drawn or built again: its boxes in their places."""
    deck = palletizing_cell().pallet
    size = OrderPallet(length=deck.size[0], width=deck.size[1], deck_height=deck.deck_height)
    boxes = []
    for event in pallet.boxes:
        item = Item.model_validate(event.data["item"])
        placed = PlacedBox(item.id, event.data["lower"], event.data["size"], item.weight)
        boxes.append(order_box(item, placed))
    return Order(order_id=name, pallet=size, boxes=tuple(boxes))


def _watched(events: Sequence[ShiftEvent]) -> dict[str, Any]:
    """What a simulator saw go wrong: contacts by when they began, and boxes on the floor."""
    touched = [event for event in events if event.kind is EventKind.TOUCHED]
    return {
        "unwanted_contacts": [f"{event.reason}, at {event.data['began']:.1f} s" for event in touched],
        "fallen": [event.box for event in events if event.kind is EventKind.FELL],
    }


def _faults(events: Sequence[ShiftEvent]) -> Counter[str]:
    """How often each state of a fault was entered."""
    states = [event.data["state"] for event in events if event.kind is EventKind.STATE and event.reason]
    return Counter(state for state in states if not state[0].isdigit())


def _times(events: Sequence[ShiftEvent]) -> tuple[dict[str, list[float]], dict[str, float]]:
    """How long each visit of each state took [s], and how long nothing was in work, by what was waited for.

    A run of the machine ends where no box has a place to go to. If one has come by then, it waits for an
    empty pallet; else the arm waits for a box.
    """
    states: dict[str, list[float]] = defaultdict(list)
    waits: dict[str, float] = defaultdict(float)
    visits = [event for event in events if event.kind in (EventKind.STATE, EventKind.BEGAN)]
    came = [event.time for event in events if event.kind is EventKind.CAME]
    for event, following in pairwise(visits):
        if EventKind.BEGAN in (event.kind, following.kind):
            continue  # what was under way when a shift was interrupted has no end
        spent = following.time - event.time
        if event.data["state"] == "done":
            arrived = next((time for time in came if event.time <= time <= following.time), event.time)
            waits["a box"] += arrived - event.time
            waits["an empty pallet or a place"] += following.time - arrived
        else:
            states[event.data["state"]].append(spent)
    return dict(states), dict(waits)


def _pallet(pallet: BuiltPallet) -> dict[str, Any]:
    boxes = pallet.boxes
    return {
        "place": pallet.place, "taken_at_s": pallet.taken, "boxes": len(boxes),
        "weight_kg": sum(box.data["item"]["weight"] for box in boxes),
        "volume_m3": float(sum(np.prod(box.data["size"]) for box in boxes)),
        "height_m": max((box.data["lower"][2] + box.data["size"][2] for box in boxes), default=0.0),
    }  # fmt: skip
