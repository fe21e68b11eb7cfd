"""The report of a shift, from nothing but its journal: throughput, pallets, faults, and where time went."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from pack_core.palletizing.cell import PALLET, SECOND_PALLET
from pack_core.palletizing.shift_journal import SETTLED, EventKind, ShiftEvent, WrittenShift

HOUR = 3600.0
"""In seconds."""
PALLETS = (PALLET, SECOND_PALLET)
"""Names of the places on which boxes count as palletized."""


def shift_report(shift: WrittenShift) -> dict[str, Any]:
    """The measures of a shift as plain values.

    `boxes_per_hour` counts boxes put down on pallets, from the first box that came to the last that was put
    down. `waits_s` is the time in which no box was in work: for a box to come and be measured, or for an
    empty pallet. `state_s` is the time in each state, a box on a pallet.
    """
    events = shift.events
    put_down = [event for event in events if event.kind is EventKind.PUT_DOWN]
    on_pallets = [event for event in put_down if event.place in PALLETS]
    came = [event for event in events if event.kind is EventKind.CAME]
    decided = [event for event in events if event.kind is EventKind.DECIDED]
    steps = Counter(event.data["step"] for event in decided)
    duration = put_down[-1].time - came[0].time if put_down and came else 0.0
    states, waits = _times(events)
    handling = Counter(event.data["handling"] for event in on_pallets)
    return {
        "seed": shift.facts.get("seed"),
        "reason": next((event.reason for event in events if event.kind is EventKind.ENDED), "it goes on"),
        "duration_s": duration,
        "came": len({event.box for event in came}),
        "settled": len({event.box for event in events if event.kind in SETTLED}),
        "on_pallets": len(on_pallets),
        "boxes_per_hour": HOUR * len(on_pallets) / duration if duration else None,
        "set_aside": steps["set aside"],
        "rejected": {event.box: event.reason for event in decided if event.data["step"] == "reject"},
        "skipped": {event.box: event.reason for event in events if event.kind is EventKind.SKIPPED},
        "lost": {event.box: event.reason for event in events if event.kind is EventKind.LOST},
        "faults": dict(_faults(events)),
        "handling": dict(handling),
        "over_table_share": handling["table"] / len(on_pallets) if on_pallets else None,
        "utilisation": 1.0 - sum(waits.values()) / duration if duration else None,
        "waits_s": dict(waits),
        "state_s": {state: float(np.sum(times)) / max(1, len(on_pallets)) for state, times in states.items()},
        "pallets": _pallets(events),
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


def _pallets(events: Sequence[ShiftEvent]) -> list[dict[str, Any]]:
    """Every pallet that was taken away: when [s], its boxes, their weight [kg] and volume [m^3]."""
    found, standing = list[dict[str, Any]](), dict[str, list[ShiftEvent]]()
    for event in events:
        if event.kind is EventKind.PUT_DOWN and event.place in PALLETS:
            standing.setdefault(event.place, []).append(event)
        elif event.kind is EventKind.TAKEN:
            boxes = standing.pop(event.place, [])
            found.append({
                "place": event.place, "taken_at_s": event.time, "boxes": len(boxes),
                "weight_kg": sum(box.data["item"]["weight"] for box in boxes),
                "volume_m3": float(sum(np.prod(box.data["size"]) for box in boxes)),
                "height_m": max((box.data["lower"][2] + box.data["size"][2] for box in boxes), default=0.0),
            })  # fmt: skip
    return found
