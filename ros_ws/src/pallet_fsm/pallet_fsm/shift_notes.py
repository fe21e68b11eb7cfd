"""What a shift notes for its journal."""

from __future__ import annotations

from pack_core.palletizing.cell import PICKING_TABLE, REJECT_TABLE
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.next_place import NextStep
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.ports import PalletObservation
from pack_core.palletizing.shift_journal import EventKind, ShiftEvent
from pack_core.rotations import Pose
from pallet_fsm.intake import Arrival
from pallet_fsm.machine import Machine
from pallet_fsm.order_book import WorkItem


class ShiftNotes:
    """Collects events until somebody fetches them.

    `observe` comes before all else in a step, as events have its time.
    """

    def __init__(self) -> None:
        self._events: list[ShiftEvent] = []
        self._time = 0.0
        self._machine: Machine | None = None
        self._noted = 0

    def observe(self, seen: PalletObservation) -> None:
        """Note the time of what happens from now on."""
        self._time = seen.time

    def fetch(self) -> tuple[ShiftEvent, ...]:
        """What has happened since the last call."""
        events, self._events = tuple(self._events), []
        return events

    def began(self, doubts: tuple[str, ...], standing: int) -> None:
        """A shift begins, or is gone on with: what is not as its journal says, and how many boxes stand."""
        self._note(EventKind.BEGAN, reason="; ".join(doubts), standing=standing)

    def ended(self, reason: str) -> None:
        """The shift has ended."""
        self._note(EventKind.ENDED, reason=reason)

    def came(self, arrival: Arrival) -> None:
        """A box was measured on the conveyor."""
        article = "" if arrival.item is None else arrival.item.article
        self._note(
            EventKind.CAME, arrival.box, PICKING_TABLE, arrival.doubt, size=arrival.dims.tolist(),
            article=article,
        )  # fmt: skip

    def decided(self, step: NextStep, box: str, place: str, reason: str, placed: PlacedBox | None) -> None:
        """It was decided where a box goes, and its place there; or that a pallet is closed."""
        found = {} if placed is None else {"lower": placed.lower.tolist(), "size": placed.size.tolist()}
        self._note(EventKind.DECIDED, box, place, reason, step=step.value, **found)

    def states(self, machine: Machine) -> None:
        """The states that a machine has entered since the last call; all of them of another machine."""
        if machine is not self._machine:
            self._machine, self._noted = machine, 0
        for visit in machine.visits[self._noted :]:
            state = {"state": visit.state.label, "event": visit.event.value if visit.event else ""}
            self._events.append(
                ShiftEvent(visit.time, EventKind.STATE, visit.box, visit.place, visit.reason, state)
            )
        self._noted = len(machine.visits)

    def put_down(self, work: WorkItem, item: Item) -> None:
        """A box was let go where it was to be."""
        assert work.X_WB is not None
        placed = work.plan.placed
        self._note(
            EventKind.PUT_DOWN, work.name, work.deck, pose=_plain(work.X_WB), handling=work.handling.value,
            lower=placed.lower.tolist(), size=placed.size.tolist(), item=item.model_dump(mode="json"),
        )  # fmt: skip

    def moved(self, work: WorkItem, reason: str) -> None:
        """A box was found to stand a little elsewhere than where it was put down."""
        assert work.X_WB is not None
        self._note(EventKind.MOVED, work.name, work.deck, reason, pose=_plain(work.X_WB))

    def skipped(self, work: WorkItem, reason: str) -> None:
        """A box was left out."""
        self._note(EventKind.SKIPPED, work.name, work.deck, reason)

    def lost(self, work: WorkItem, reason: str) -> None:
        """A box fell, or is not where it was put down."""
        self._note(EventKind.LOST, work.name, work.deck, reason)

    def pallet_taken(self, place: str, boxes: tuple[str, ...]) -> None:
        """A pallet is taken away with the boxes on it."""
        self._note(EventKind.TAKEN, place=place, boxes=list(boxes))

    def reject_taken(self, box: str) -> None:
        """A box is taken away from where boxes are rejected."""
        self._note(EventKind.TAKEN, box, REJECT_TABLE, boxes=[box])

    def _note(
        self, kind: EventKind, box: str = "", place: str = "", reason: str = "", **data: object
    ) -> None:
        self._events.append(ShiftEvent(self._time, kind, box, place, reason, data))


def _plain(X_WB: Pose) -> list[float]:
    """A pose as a journal has it: position [m], then the quaternion w, x, y, z."""
    return [*X_WB.p.tolist(), *X_WB.q.tolist()]
