"""A shift: boxes come as they come, each gets a place when it is there, and full pallets are replaced.

It is a job above the machine, as an order is: the machine runs through its states box by box, and is begun
anew when a box comes after none was left. The shift says which box is next and where it goes. It has no
clock and calls nothing outside: a step takes an observation and returns commands.
"""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.palletizing.cell import PICKING_TABLE, REJECT_TABLE, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import PlannedBox
from pack_core.palletizing.orders.next_place import NextStep, PlaceAnswer, PlaceQuestion
from pack_core.palletizing.ports import AskPlace, Command, DiscardBox, PalletObservation, TakePallet
from pack_core.palletizing.shift_journal import ShiftEvent
from pallet_fsm.intake import Intake, IntakeConfig
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.place_watch import ArmShadow
from pallet_fsm.report import BoxOutcome
from pallet_fsm.shift_floor import ShiftFloor
from pallet_fsm.shift_notes import ShiftNotes
from pallet_fsm.states import State
from pallet_fsm.taking_over import TakenOver


class ShiftConfig(Config):
    """Parameters of a shift, besides those of the machine."""

    intake: IntakeConfig = IntakeConfig()
    most_rejects: PositiveInt = Field(
        default=3, description="rejected boxes in a row after which a person is called"
    )
    patience: PositiveFloat = Field(
        default=120.0, description="time without a box after which a shift that waits for one ends [s]"
    )
    answer: PositiveFloat = Field(
        default=10.0, description="longest time until it is answered where a box goes [s]"
    )
    away: PositiveFloat = Field(
        default=0.3, description="distance of arm and carried box from a pallet, seen from above, from which "
        "on it is taken away [m]",
    )  # fmt: skip

    def clearances(self, cell: PalletizingCell) -> dict[str, float]:
        """From which distance on the arm is out of the way of each place, before a shift begins [m]."""
        pallets = dict.fromkeys(cell.pallets, self.away)
        return {PICKING_TABLE: self.intake.clear, REORIENTATION_TABLE: 0.0, **pallets}


class ShiftJob:
    """Runs a shift.

    Args:
        cell: the cell's physical facts; it has what shifts need.
        catalogue: what each label stands for.
        config: parameters.
        machine: parameters of the machine.
        boxes: the shift ends when so many have come and are in their places.
        taken_over: what stands already, on pallets and on table B; by default nothing.

    Attributes:
        machine: what moves the arm at present; None while no box is to be moved.
        reason: why the shift has ended; empty while it goes on.
    """

    def __init__(
        self, cell: PalletizingCell, catalogue: Mapping[str, Item], config: ShiftConfig,
        machine: PalletizerConfig, boxes: int, taken_over: TakenOver | None = None,
    ) -> None:  # fmt: skip
        found = taken_over or TakenOver()
        self._cell, self._config, self._machine_config, self._boxes = cell, config, machine, boxes
        self._intake = Intake(cell, catalogue, config.intake)
        self._floor = ShiftFloor(cell, found.standing)
        self._shadows = {
            block.name: ArmShadow(block, cell) for block in cell.furniture if block.name in cell.pallets
        }
        self._came = self._rejects = self._asked = 0
        self._sent = self._asked_at = 0.0
        self._arriving: WorkItem | None = None
        self._unreported: list[WorkItem] = []
        self._closing = set(found.closed)
        self._question: PlaceQuestion | None = None
        self._blocked: frozenset[str] | None = None
        self._notes = ShiftNotes()
        self._found: TakenOver | None = found
        self._halt = self._ending = ""
        self.machine: Palletizer | None = None
        self.reason = ""

    @property
    def is_over(self) -> bool:
        """Whether the shift has ended."""
        return bool(self.reason)

    def events(self) -> tuple[ShiftEvent, ...]:
        """What has happened since the last call."""
        return self._notes.fetch()

    def halt(self, reason: str) -> None:
        """Stop the arm safely at the next step."""
        self._halt = reason
        if self.machine is not None:
            self.machine.halt(reason)

    def step(self, seen: PalletObservation) -> tuple[Command, ...]:
        """Go as far as the observation allows, and return the commands of this step."""
        if self.is_over:
            return ()
        self._notes.observe(seen)
        commands = [*self._begin(), *self._take_in(seen), *self._decide(seen), *self._clear_away(seen)]
        if self.machine is None and self._floor.pending:
            self.machine = Palletizer(self._floor.begin(), self._cell, self._machine_config, seen.time)
        if self.machine is not None:
            self._tell_of_next()
            commands += self.machine.step(seen)
            self._follow_machine()
        self._end(seen)
        return tuple(commands)

    def _begin(self) -> list[Command]:
        """Note what was taken over, once, and have rejected boxes taken away that are still there."""
        found, self._found = self._found, None
        if found is None:
            return []
        self._notes.began(found.doubts, len(self._floor.work))
        for work, reason in found.moved:
            self._notes.moved(work, reason)
        for work, reason in found.lost:
            self._notes.lost(work, reason)
        for box in found.rejected:
            self._notes.reject_taken(box)
        return [DiscardBox(box) for box in found.rejected]

    def _wind_up(self, reason: str) -> None:
        """Take nothing more in, and end once the arm has done what it is at."""
        self._ending = self._ending or reason

    @property
    def _busy(self) -> WorkItem | None:
        """The box that the machine is busy with, or was last."""
        return None if self.machine is None else self.machine.item

    def _tell_of_next(self) -> None:
        """Have the arm keep clear of the box that comes until that is found, or wait if that is soon."""
        coming, book = self._arriving, self._floor.book
        assert book is not None
        is_unseen = coming is not self._busy and coming is not None and coming.X_WB is None
        book.others = self._intake.obstacles() if coming is None or is_unseen else ()
        book.is_next_coming = is_unseen or self._intake.is_measuring or self._question is not None

    def _take_in(self, seen: PalletObservation) -> list[Command]:
        """Have the next box brought once the last one has left the conveyor, and have it measured."""
        intake, before = self._intake, self._intake.arrival
        if before is not None and self._arriving is not None and self._has_left(self._arriving, seen):
            self._arriving = None
            intake.clear()
        has_box = intake.arrival is not None or intake.is_sent
        if not has_box and self._came < self._boxes and not self._ending:
            self._sent = seen.time
            return [intake.send()]
        commands = list(intake.step(seen, self._busy))
        if intake.arrival is not None and before is None:
            self._came += 1
            self._notes.came(intake.arrival)
        if intake.reason:
            self._wind_up(intake.reason)
        return commands

    def _has_left(self, work: WorkItem, seen: PalletObservation) -> bool:
        """Whether a box is neither on the conveyor nor over it any more, and does not come back."""
        if work.is_finished or work is not self._busy:
            return work.is_finished
        assert self.machine is not None
        is_away = work.X_TB is not None or work.approach is not None
        return is_away and not self.machine.is_weighing and self._intake.is_clear(seen, work)

    def _decide(self, seen: PalletObservation) -> list[Command]:
        """Ask where the box goes that has come, and do what is answered."""
        if self._question is not None:
            answer = seen.place
            if answer is None or answer.number != self._question.number:
                if seen.time <= self._asked_at + self._config.answer:
                    return []
                self._wind_up("nobody answers where the next box goes")
                answer = None
            asked, self._question = self._question, None
            if self._is_placing_anew and asked.known[0].id == self._held.name:
                self._place_anew(self._held, answer)
            elif answer is not None:
                self._follow(answer, seen)
        if self._is_placing_anew:
            return self._ask_anew(self._held, seen)
        arrival = self._intake.arrival
        has_upcoming = any(work is not self._busy for work in self._floor.pending)
        if arrival is None or self._arriving is not None or has_upcoming or self._ending:
            return []
        if arrival.item is None:
            self._send_away(arrival.doubt)
            return []
        places = self._open_pallets(seen)
        if not places or self._blocked == frozenset(places):
            return []
        self._asked, self._asked_at = self._asked + 1, seen.time
        floor = self._floor
        self._question = PlaceQuestion(
            self._asked, tuple(floor.standing(place) for place in places), floor.buffered, (arrival.item,),
            len(floor.free_buffers),
        )  # fmt: skip
        return [AskPlace(self._question)]

    @property
    def _is_placing_anew(self) -> bool:
        """Whether there was no way to the place of the box in the hand."""
        return self._floor.book is not None and self._floor.book.is_placing_anew

    @property
    def _held(self) -> WorkItem:
        """The box in the hand."""
        assert self._floor.book is not None
        return self._floor.book.current

    def _ask_anew(self, work: WorkItem, seen: PalletObservation) -> list[Command]:
        """Ask for a place of the box in the hand on another pallet than those to which there was no way."""
        places = [place for place in self._open_pallets(seen) if place not in work.refused]
        if not places or self._ending:
            self._place_anew(work, None)
            return []
        self._asked, self._asked_at = self._asked + 1, seen.time
        standing = tuple(self._floor.standing(place) for place in places)
        self._question = PlaceQuestion(self._asked, standing, (), (self._floor.held(work),), 0)
        return [AskPlace(self._question)]

    def _place_anew(self, work: WorkItem, answer: PlaceAnswer | None) -> None:
        """Bring the box in the hand where was answered, else to table B, else to where boxes are rejected."""
        found: tuple[PlannedBox, str] | None = None
        step = NextStep.PLACE
        if answer is not None and answer.plan is not None:
            found = answer.plan, answer.pallet
        elif found := self._floor.refuge(work):
            step = NextStep.SET_ASIDE if found[1] == REORIENTATION_TABLE else NextStep.REJECT
        if found is not None:
            plan, deck = found
            self._floor.put_elsewhere(work, plan, deck)
            self._notes.decided(step, work.name, deck, "there is no way to its first place", plan.placed)
        assert self._floor.book is not None
        self._floor.book.is_placing_anew = False

    def _open_pallets(self, seen: PalletObservation) -> list[str]:
        return [place for place in self._cell.pallets if place not in self._closing | seen.taken]

    def _follow(self, answer: PlaceAnswer, seen: PalletObservation) -> None:
        """Do what was answered."""
        arrival, self._blocked = self._intake.arrival, None
        assert arrival is not None
        match answer.step:
            case NextStep.PLACE:
                self._expect(self._floor.place(answer, arrival))
            case NextStep.SET_ASIDE if arrival.item is not None:
                self._expect(self._floor.set_aside(arrival.item))
            case NextStep.REJECT:
                self._send_away(answer.reason)
                return
            case NextStep.CLOSE:
                places = self._open_pallets(seen)
                if len(places) < len(self._cell.pallets):
                    self._blocked = frozenset(places)  # an empty pallet comes soon
                    return
                self._closing.add(answer.pallet)
        placed = None if answer.plan is None else answer.plan.placed
        self._notes.decided(answer.step, answer.item, answer.pallet, answer.reason, placed)

    def _expect(self, work: WorkItem) -> None:
        """Note that the machine is to move a box."""
        self._unreported.append(work)
        if work.source == PICKING_TABLE:
            self._arriving = work
            self._rejects = self._rejects + 1 if work.deck == REJECT_TABLE else 0

    def _send_away(self, reason: str) -> None:
        """Have the box that came put where somebody takes it away, or call a person to take it."""
        arrival = self._intake.arrival
        assert arrival is not None
        self._notes.decided(NextStep.REJECT, arrival.box, REJECT_TABLE, reason, None)
        if arrival.X_WB is None:
            self._wind_up(f"take box {arrival.box} off the conveyor: {reason}")
            return
        self._expect(self._floor.send_away(arrival))
        if self._rejects >= self._config.most_rejects:
            self._wind_up(f"{self._rejects} boxes in a row belong on no pallet: look at the conveyor")

    def _note_changes(self) -> None:
        """Note boxes that are gone, and those that stand a little elsewhere.

        What was to come to a pallet on which one was moved is decided on anew.
        """
        book = self._floor.book
        assert book is not None
        moved, lost = book.relocated, book.lost
        book.relocated, book.lost = [], []
        for work in lost:
            self._notes.lost(work, work.reason)
        for work, reason in moved:
            self._notes.moved(work, reason)
            self._question = None
            for other in self._floor.pending:
                if other is not self._busy and other.deck == work.deck:
                    other.finish(BoxOutcome.SKIPPED, reason)

    def _follow_machine(self) -> None:
        """Note the states that were entered, and what became of boxes."""
        assert self.machine is not None
        self._note_changes()
        machine = self.machine.machine
        self._notes.states(machine)
        for work in [work for work in self._unreported if work.is_finished]:
            self._unreported.remove(work)
            self._note_outcome(work)
        if machine.state is State.SAFE_STOP:
            self.reason = machine.reason or "the arm has stopped"
        elif machine.state is State.DONE:
            self.machine = self._floor.book = None

    def _note_outcome(self, work: WorkItem) -> None:
        if work.outcome is BoxOutcome.SKIPPED and work is not self._busy:
            self._floor.decide_anew(work)  # what it was to stand on is not there
            self._arriving = None if work is self._arriving else self._arriving
            return
        match work.outcome:
            case BoxOutcome.PLACED:
                self._notes.put_down(work, self._floor.item(work.name))
            case BoxOutcome.SKIPPED:
                self._notes.skipped(work, work.reason)
            case _:
                self._notes.lost(work, work.reason)

    def _clear_away(self, seen: PalletObservation) -> list[Command]:
        """Have rejected boxes and full pallets taken away that the arm has left, and forget skipped boxes."""
        commands: list[Command] = []
        for work in [work for work in self._floor.work if work.outcome is BoxOutcome.SKIPPED]:
            if work is not self._busy and work not in self._unreported:
                self._floor.forget(work)
        for work in self._floor.boxes_of(REJECT_TABLE):
            if work.is_finished and work is not self._busy:
                self._floor.forget(work)
                self._notes.reject_taken(work.name)
                commands.append(DiscardBox(work.name))
        for place in sorted(self._closing):
            boxes, busy = self._floor.boxes_of(place), self._busy
            carried = None if busy is None else busy.carried
            is_away = self._shadows[place].clearance(seen.motion.X_WT, carried) >= self._config.away
            if not is_away or busy in boxes or any(not work.is_finished for work in boxes):
                continue
            self._closing.discard(place)
            for work in boxes:
                self._floor.forget(work)
            names = tuple(work.name for work in boxes if work.outcome is BoxOutcome.PLACED)
            self._notes.pallet_taken(place, names)
            commands.append(TakePallet(place, names))
        return commands

    def _end(self, seen: PalletObservation) -> None:
        """End where nothing is left to do, or where a person is needed."""
        if self.machine is None:
            self.reason = self._halt or self._why_done(seen)
        if self.reason:
            self._notes.ended(self.reason)

    def _why_done(self, seen: PalletObservation) -> str:
        """Why nothing is left to do for an arm that rests; empty where something is."""
        if self._floor.pending or self._closing or self._floor.boxes_of(REJECT_TABLE):
            return ""  # what is full or rejected is taken away first
        if self._ending:
            return self._ending
        if self._intake.arrival is not None:
            return ""
        if self._came >= self._boxes:
            return "all boxes came"
        is_late = self._intake.is_waiting and seen.time > self._sent + self._config.patience
        return f"no box has come for {self._config.patience:g} s" if is_late else ""
