"""Takes over pallets that stand half built, and boxes that were set aside: by the journal, and by looking.

The journal says what was put down where and what it is, also of boxes that others cover. A scan of each place
says whether that still stands: a box that was moved a little is known to stand elsewhere from then on; a
pallet on which more than that has changed is closed, and somebody takes it away. Table B, where boxes are set
aside, must be put right by somebody before the shift goes on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import REJECT_TABLE, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.item_list import Item, order_box
from pack_core.palletizing.orders.layout_plan import PlannedBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.scanner import PlaceScan
from pack_core.palletizing.shift_journal import EventKind, ShiftEvent
from pack_core.rotations import Pose
from pack_perception.scans.comparison import Oddity, ScannedScene, compare
from pack_perception.scans.rays import Rays
from pallet_fsm.order_book import WorkItem, as_it_stands, standing_box
from pallet_fsm.palletizer_config import ScanConfig
from pallet_fsm.place_watch import WORDS, is_small, moved_pose
from pallet_fsm.report import BoxOutcome
from pallet_fsm.shift_floor import STRAIGHT_DOWN


@dataclass(frozen=True)
class TakenOver:
    """What stands in the cell.

    Attributes:
        standing: the boxes on pallets and on table B, with what they are.
        closed: names of the places whose pallet is to be taken away, as too much has changed on it.
        doubts: what is not as the journal says, in words.
        moved: those of the boxes that stand a little elsewhere, with how far, in words.
        lost: the boxes that are gone, with where that was seen, in words.
        rejected: names of the boxes that somebody has to take from where boxes are rejected.
    """

    standing: tuple[tuple[WorkItem, Item], ...] = ()
    closed: frozenset[str] = frozenset()
    doubts: tuple[str, ...] = ()
    moved: tuple[tuple[WorkItem, str], ...] = ()
    lost: tuple[tuple[WorkItem, str], ...] = ()
    rejected: tuple[str, ...] = ()


def standing_by_journal(events: Iterable[ShiftEvent]) -> list[tuple[WorkItem, Item]]:
    """The boxes that must stand on pallets and on table B, in the sequence in which they were put down."""
    return [_standing(event) for event in _put_down(events) if event.place != REJECT_TABLE]


def rejected_by_journal(events: Iterable[ShiftEvent]) -> tuple[str, ...]:
    """Names of the boxes that were put where boxes are rejected, and that nobody was told to take away."""
    return tuple(event.box for event in _put_down(events) if event.place == REJECT_TABLE)


def _put_down(events: Iterable[ShiftEvent]) -> list[ShiftEvent]:
    """The events with which the boxes were put down that have not left the cell since."""
    found: dict[str, ShiftEvent] = {}
    for event in events:
        match event.kind:
            case EventKind.PUT_DOWN:
                found.pop(event.box, None)
                found[event.box] = event
            case EventKind.MOVED if event.box in found:
                data = {**found[event.box].data, "pose": event.data["pose"]}
                found[event.box] = replace(found[event.box], data=data)
            case EventKind.LOST | EventKind.SKIPPED:
                found.pop(event.box, None)
            case EventKind.TAKEN:
                found = {name: one for name, one in found.items() if one.place != event.place}
    return list(found.values())


def _standing(event: ShiftEvent) -> tuple[WorkItem, Item]:
    data = event.data
    item = Item.model_validate(data["item"])
    lower, size = np.array(data["lower"]), np.array(data["size"])
    plan = PlannedBox(PlacedBox(event.box, lower, size, item.weight), STRAIGHT_DOWN)
    X_WB = Pose(np.array(data["pose"][:3]), np.array(data["pose"][3:]))
    return (
        WorkItem(
            order_box(item, plan.placed), plan, event.place, has_come=True, X_WB=X_WB,
            outcome=BoxOutcome.PLACED,
        ),
        item,
    )  # fmt: skip


def take_over(
    boxes: list[tuple[WorkItem, Item]], scans: Mapping[str, PlaceScan], cell: PalletizingCell,
    config: ScanConfig,
) -> TakenOver:  # fmt: skip
    """Compare what must stand with what is seen.

    Args:
        boxes: what must stand, as `standing_by_journal` gives it; boxes that were moved a little are
            changed in place.
        scans: of both pallets and of table B, by the names of the places; the arm hid nothing of them.
        cell: the cell's physical facts.
        config: what counts as a change, and what is so small that a pallet is gone on with.

    Raises:
        ConfigError: something on table B is not as it was left.
    """
    blocks = {block.name: block for block in cell.furniture}
    closed, doubts = set[str](), list[str]()
    moved, lost = list[tuple[WorkItem, str]](), list[tuple[WorkItem, str]]()
    for place in (*cell.pallets, REORIENTATION_TABLE):
        there = {work.name: work for work, _ in boxes if work.deck == place}
        expected = tuple(
            standing_box(work.box, work.X_WB) for work in there.values() if work.X_WB is not None
        )
        rays = Rays.of(scans[place], cell.scanner_pose(place))
        least = config.tolerances.area / cell.scanner(place).spacing ** 2
        for finding in compare(ScannedScene(rays, blocks[place], expected, least), config.tolerances):
            doubts.append(f"{place.replace('_', ' ')}: {finding}")
            work = there.get(finding.box)
            if work is not None and work.X_WB is not None and is_small(finding, config.small):
                work.X_WB = moved_pose(finding, work.X_WB)
                moved.append((work, str(finding)))
                continue
            if work is not None and finding.oddity is Oddity.MISSING:
                lost.append((work, f"seen on {WORDS[place]}: {finding}"))
            elif place == REORIENTATION_TABLE:
                raise ConfigError(f"table B: {finding}; take it off, then go on")
            if place != REORIENTATION_TABLE:
                closed.add(place)
    gone = {work.name for work, _ in lost}
    standing = tuple((work, item) for work, item in boxes if work.name not in gone)
    for work, _ in standing:
        work.plan = replace(work.plan, placed=as_it_stands(work, cell))
    return TakenOver(standing, frozenset(closed), tuple(doubts), tuple(moved), tuple(lost))
