"""An order or shift in progress: the machine, the box in work, and the commands to the cell, step by step.

It has no clock and calls nothing outside: a step takes an observation and returns commands.
"""

from __future__ import annotations

from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.ports import (
    CloseGripper,
    Command,
    DiscardBox,
    OpenGripper,
    PalletObservation,
    PursueTarget,
    StopArm,
)
from pallet_fsm import goals, place_watch
from pallet_fsm.box_watch import BoxWatch
from pallet_fsm.leg_runner import LegRunner
from pallet_fsm.load_watch import LoadWatch
from pallet_fsm.machine import Machine
from pallet_fsm.order_book import OrderBook, WorkItem
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.place_watch import PlaceWatch
from pallet_fsm.report import BoxOutcome, OrderReport
from pallet_fsm.states import CARRYING, FAULTS, HOLDING, ROWS, Grip, Place, State, profile_of
from pallet_fsm.transitions import Event, Guard


class GripCycle:
    """Runs one closing or opening of the gripper at a time.

    Args:
        dwell: time for the vacuum to build up or break down [s].
        timeout: longest time until the gripper has carried out a command [s].

    Attributes:
        is_busy: whether a closing or opening is under way.
        reason: why the last one failed; empty if it did not.
    """

    def __init__(self, dwell: float, timeout: float) -> None:
        self._dwell, self._timeout = dwell, timeout
        self._grip = Grip.EMPTY
        self._start = 0.0
        self.is_busy = False
        self.reason = ""

    def begin(self, grip: Grip, time: float) -> Command:
        """Close or open the gripper; then `note` is to be called until it returns an event."""
        self._grip, self._start, self.is_busy, self.reason = grip, time, True, ""
        return CloseGripper() if grip is Grip.CLOSE else OpenGripper()

    def note(self, state: GripState, time: float) -> Event | None:
        """The event that ends the closing or opening; None while it is under way.

        A gripper that is open with the reason `ASKED` was opened before and has not answered a closing yet.
        """
        waited = time - self._start
        if waited < self._dwell:
            return None
        wanted = self._grip is Grip.CLOSE
        if state.is_closed is wanted:
            return self._end(Event.GRIPPED if wanted else Event.RELEASED)
        answer = "" if state.is_closing or state.reason == ASKED else state.reason
        if not (wanted and answer) and waited < self._timeout:
            return None
        self.reason = answer or f"the gripper does not {self._grip.value}"
        return self._end(Event.GRIP_FAILED if wanted else Event.HALTED)

    def cut_short(self, state: GripState) -> Event | None:
        """End an opening before its time if the gripper is open already; None where it is not."""
        is_open = self.is_busy and self._grip is Grip.OPEN and not state.is_closed
        return self._end(Event.RELEASED) if is_open else None

    def _end(self, event: Event) -> Event:
        self.is_busy = False
        return event


TOWARDS_BOX = (State.ABOVE_BOX, State.GRASP)
"""States in which the box on table A is looked at a second time."""


class Palletizer:
    """Puts boxes in their places, one after the other: those of an order, or those that a shift adds.

    Args:
        book: the boxes, and where each of them goes.
        cell: the cell's physical facts.
        config: parameters.
        time: now [s].
    """

    def __init__(self, book: OrderBook, cell: PalletizingCell, config: PalletizerConfig, time: float) -> None:
        self._book, self._config, self._X_WP = book, config, cell.pallet.X_WP
        self._profile = profile_of(config.profile)
        self._watch = BoxWatch(config, cell)
        self._places = PlaceWatch(config.scans, cell, self._book)
        self._load = LoadWatch(config.weighing, cell)
        self._grip = GripCycle(config.dwell, config.grip_patience)
        self.machine = Machine(time, self._holds, self.item.name, self.item.deck)
        self._legs = LegRunner(self._profile, self._book, cell, config, self._stop_after)
        self._commands: list[Command] = []
        self._halt = ""

    @property
    def item(self) -> WorkItem:
        """The box in work."""
        return self._book.current

    @property
    def is_weighing(self) -> bool:
        """Whether the box in the hand may still turn out to be another one, and go back to where it was."""
        return self._load.is_weighing

    @property
    def leg_end(self) -> State | None:
        """The state at whose target the arm's present move ends; None while it makes none."""
        return self._legs.end

    def report(self) -> OrderReport:
        """A report of the order so far."""
        boxes = self._book.reports()
        is_complete = all(box.outcome is BoxOutcome.PLACED for box in boxes)
        reason = self.machine.reason if self.machine.state is State.SAFE_STOP else ""
        return OrderReport(
            self._book.name, is_complete, reason, boxes, tuple(self.machine.visits), self._X_WP
        )

    def halt(self, reason: str) -> None:
        """Stop safely at the next step."""
        self._halt = reason

    def step(self, seen: PalletObservation) -> tuple[Command, ...]:
        """Go through as many states as the observation allows, and return the commands of this step."""
        self._commands = []
        self._watch.observe(seen)
        self._places.observe(seen)
        self._load.observe(seen)
        while not self.machine.is_over and (found := self._happened(seen)) is not None:
            self._fire(*found, seen)
        if not self.machine.is_over:
            self._feed_ahead(seen)
        return (*self._commands, *self._watch.commands(), *self._places.commands())

    def _happened(self, seen: PalletObservation) -> tuple[Event, str] | None:
        """The event that takes the machine on, and its reason; None while there is none."""
        state = self.machine.state
        goes_back = state in (State.BOX_CHANGED, State.WRONG_WEIGHT)
        if goes_back and not _is_standing(seen.motion) and not self._halt:
            return None  # it goes back from where it comes to rest
        if self._book.is_placing_anew and not self._halt:
            return None
        if state in FAULTS:
            return Event.ASSESSED, self._halt
        if state is State.SKIP_BOX:
            return Event.SKIPPED, ""
        if self._halt:
            # A box that is out of the hand stands where it is, which must be known when the arm has stopped.
            released = self._grip.cut_short(seen.grip)
            return (Event.HALTED, self._halt) if released is None else (released, "")
        if (change := self._places.change(state, seen.time)) is not None:
            return change
        if state is State.SPAWN:
            return self._watch.arrival(self.item, seen.time)
        if state is State.DETECT:
            return self._watch.sighting(self.item, seen.time)
        return self._motion(state, seen)

    def _motion(self, state: State, seen: PalletObservation) -> tuple[Event, str] | None:
        if self._grip.is_busy:
            event = self._grip.note(seen.grip, seen.time)
            return (event, self._grip.reason) if event is not None else None
        if state in HOLDING and not seen.grip.is_closed:
            has_let_go = seen.grip.reason not in ("", ASKED)
            return (
                Event.LIMIT_PASSED if has_let_go else Event.BOX_LOST,
                seen.grip.reason or "nothing in the hand",
            )
        if state in CARRYING and (fault := self._load.fault()):
            return Event.WRONG_WEIGHT, fault
        if state in TOWARDS_BOX and (change := self._watch.change(seen)) is not None:
            return change
        if self._waits_for_sight(state) and _is_standing(seen.motion):
            return None
        if self._awaits_next(state, seen.time):
            return None
        outcome = self._legs.follow(state, self.item, seen)
        if isinstance(outcome, PursueTarget):
            self._commands.append(outcome)
            return None
        if outcome is Event.REACHED and ROWS[state].grip in (Grip.CLOSE, Grip.OPEN):
            self._commands.append(self._grip.begin(ROWS[state].grip, seen.time))
            return None
        return None if outcome is None else (outcome, self._legs.reason)

    def _waits_for_sight(self, state: State) -> bool:
        """Whether the gripper must not act, nor the box be left, before what was looked at last is known."""
        if state is State.GRASP and self._watch.is_looking:
            return True
        has_an_end = ROWS[state].grip in (Grip.CLOSE, Grip.OPEN) or state is State.RETURN
        return has_an_end and self._places.is_looking

    def _awaits_next(self, state: State, time: float) -> bool:
        """Whether the arm stays where it let a box go, as the way to the next one is known in a moment.

        Without it the arm goes to its safe position first, which costs some seconds.
        """
        is_at_rest = state is State.RETREAT and self._legs.end is None and self._profile.feeds_ahead
        is_soon = self._book.is_next_coming or self._watch.is_about_to_find(self._book.upcoming)
        return is_at_rest and is_soon and time < self.machine.since + self._config.feeder.linger

    def _fire(self, event: Event, reason: str, seen: PalletObservation) -> None:
        before = self.machine.state
        self._take_effect(event, before, seen)
        # A target is reached, or passed, when it was measured; the observation comes some time later.
        time = max(seen.motion.time, self.machine.since) if event is Event.REACHED else seen.time
        state = self.machine.fire(event, time, self.item.name, self.item.deck, reason=reason)
        if state in FAULTS:
            self._note_fault(state, before)
        elif state is State.SKIP_BOX:
            self._book.skip(self.machine.reason)
            self._commands.append(DiscardBox(self.item.name))
        elif state is State.SAFE_STOP:
            self._commands.append(StopArm())

    def _take_effect(self, event: Event, state: State, seen: PalletObservation) -> None:
        """Update the box in work after an event."""
        item, X_WT = self.item, seen.motion.X_WT
        if event is Event.GRIPPED:
            item.take(X_WT)
            item.X_WG = X_WT if ROWS[state].place is Place.TABLE_A else None
            self._load.take(item)
            self._legs.note_grip(state, item)
            item.approach = None
        elif event is Event.RELEASED:
            item.let_go(X_WT, self._config.poses.drop)
            self._load.let_go()
            if ROWS[state].place is Place.PALLET:
                item.finish(BoxOutcome.PLACED)
            elif state is State.PUT_BACK:
                item.tries[state] += 1
                self._watch.forget(item)
            else:
                item.approach = self._legs.approach
        elif event is Event.REACHED and state is State.RETURN:
            self._book.advance()

    def _note_fault(self, fault: State, before: State) -> None:
        self.item.tries[fault] += 1
        may_have_moved = before in ROWS and ROWS[before].place is Place.TABLE_A  # the pad pushed it
        if fault in (State.NO_DETECTION, State.WRONG_SIZE) or may_have_moved:
            self._watch.forget(self.item)
        if fault is State.NOT_CLEAR and self.item.X_TB is not None:
            self.item.refused.add(self.item.deck)
            self._book.is_placing_anew = before in CARRYING and self._book.finds_places
        if fault is State.PLACE_CHANGED:
            self._places.note_loss()
        if fault in (State.MOTION_STUCK, State.BOX_CHANGED, State.WRONG_WEIGHT):
            self._commands.append(StopArm())
        if fault is State.BOX_CHANGED:
            self._watch.forget(self.item)
        if fault in (State.BOX_CHANGED, State.WRONG_WEIGHT):
            self._legs.drop()
        if fault in (State.BOX_LOST, State.LIMIT_PASSED):
            self.item.finish(BoxOutcome.LOST, self.machine.reason)

    def _feed_ahead(self, seen: PalletObservation) -> None:
        """Send for the next box and have it detected while this one is on its way.

        A box that is being weighed may have to go back to table A.
        """
        row, item, upcoming = ROWS.get(self.machine.state), self.item, self._book.upcoming
        if not self._profile.feeds_ahead or row is None or not row.feeds or upcoming is None:
            return
        is_done_with_table_a = item.outcome is BoxOutcome.PLACED or (
            item.X_TB is not None and not self._load.is_weighing
        )
        if is_done_with_table_a:
            self._watch.feed_ahead(upcoming, seen, item.carried)

    def _stop_after(self, state: State) -> State:
        return self.machine.stop_after(state, self._profile.stops_at)

    def _holds(self, guard: Guard) -> bool:
        """Whether a condition of the table of transitions holds for the box in work."""
        item, book = self.item, self._book
        # In a state of a fault, its tries are counted.
        has_tries = item.tries[self.machine.state] < self._config.tries
        return {
            Guard.IS_UPRIGHT: item.handling is Handling.NONE,
            Guard.IS_FLIP: item.handling is Handling.FLIP,
            Guard.HAS_TRIES: has_tries,
            Guard.HAS_NO_TRIES: not has_tries,
            Guard.HAS_BOXES: book.has_boxes,
            Guard.IS_HOLDING: item.X_TB is not None,
            Guard.IS_FINISHED: item.is_finished,
            Guard.IS_ON_TABLE: item.approach is not None,
            Guard.IS_FROM_TABLE_A: item.X_WG is not None,
            Guard.HAS_OTHER_PLACE: item.X_TB is not None and item.deck not in item.refused,
            Guard.IS_UNSEEN: item.X_WB is None and item.X_TB is None,
        }[guard]


def warm_up() -> None:
    """Have numba compile what the machine needs before the first box; loads it where that was done before."""
    goals.warm_up()
    place_watch.warm_up()


def _is_standing(motion: MotionStatus) -> bool:
    """Whether the arm has ended its move, one way or the other."""
    return motion.state not in (MotionState.MOVING, MotionState.SETTLING, MotionState.HELD)
