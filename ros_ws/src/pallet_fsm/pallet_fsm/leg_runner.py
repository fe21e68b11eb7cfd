"""Runs the machine's states as legs, one after the other, each with the obstacles that it may touch."""

from __future__ import annotations

from collections.abc import Callable

from pack_core.palletizing.cell import PICKING_TABLE, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.ports import PalletObservation, PursueTarget
from pack_core.rotations import Array
from pallet_fsm.blended_moves import BlendedMoves
from pallet_fsm.goals import Goals
from pallet_fsm.mover import Mover
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.profile import Profile
from pallet_fsm.states import ROWS, Grip, Place, State
from pallet_fsm.thesis_moves import ThesisMoves
from pallet_fsm.transitions import Event
from pallet_fsm.work_item import WorkItem

TABLES = {Place.TABLE_A: PICKING_TABLE, Place.TABLE_B: REORIENTATION_TABLE}
"""Name of the obstacle of each table on which boxes are gripped."""


class LegRunner:
    """Begins and follows the legs of the arm.

    Args:
        profile: how states become moves.
        book: the order's boxes.
        cell: the cell's physical facts.
        config: parameters.
        stop_after: gives the next state from a given one on at whose target the arm stops.

    Attributes:
        approach: approach direction of the tool at the end of the last leg, at table B; else None.
    """

    def __init__(
        self, profile: Profile, book: OrderBook, cell: PalletizingCell, config: PalletizerConfig,
        stop_after: Callable[[State], State],
    ) -> None:  # fmt: skip
        self._book, self._stop_after = book, stop_after
        self._mover = Mover(profile, config.mover)
        goals = Goals(cell, config.poses)
        self._moves = (
            BlendedMoves(goals, config.blended, config.thesis)
            if profile.is_blended
            else ThesisMoves(goals, config.thesis)
        )
        self._touched: frozenset[str] = frozenset()
        self.approach: Array | None = None

    @property
    def reason(self) -> str:
        """Why the last leg failed; empty if it did not."""
        return self._mover.reason

    @property
    def end(self) -> State | None:
        """The state in which the present leg ends; None between legs."""
        return None if self._mover.leg is None else self._mover.leg.end

    def note_grip(self, state: State) -> None:
        """Note that the box was gripped at the state's target: it still touches what it stands on."""
        place = ROWS[state].place
        self._touched = frozenset({TABLES[place]}) if place in TABLES else frozenset()

    def drop(self) -> None:
        """Give up the leg that runs; the next call of `follow` begins another one."""
        self._mover.leg = None

    def follow(self, state: State, item: WorkItem, seen: PalletObservation) -> Event | PursueTarget | None:
        """Begin a leg in `state` or follow the one that runs."""
        if self._mover.leg is None:
            return self._begin(state, item, seen)
        leg = self._mover.leg
        outcome = self._mover.follow(seen.motion, state)
        if outcome is Event.REACHED and self._mover.leg is None:
            self.approach = leg.approach
            self._touched = self._touched_at(leg.end, item)
        return outcome

    def _begin(self, state: State, item: WorkItem, seen: PalletObservation) -> Event | PursueTarget:
        target: WorkItem | None = item
        if state in (State.RETREAT, State.RETURN):
            target = self._book.upcoming if item.is_finished else None
        legs = [
            (leg, self._touched | self._touched_at(leg.end, target))
            for leg in self._moves.legs(state, self._stop_after(state), target, seen.motion.X_WT)
        ]
        return self._mover.begin(legs, item.carried, self._book.obstacles(), seen.time)

    def _touched_at(self, end: State, item: WorkItem | None) -> frozenset[str]:
        """Names of the obstacles that the pad or its box touches, or nearly touches, where a leg ends."""
        row = ROWS[end]
        if item is None or row.place is None:
            return frozenset()
        if row.grip is Grip.CLOSE:  # the empty pad comes down on the box and touches nothing else
            return frozenset({item.name})
        return frozenset({item.name}) | self._standing_on(row.place, item)

    def _standing_on(self, place: Place, item: WorkItem) -> frozenset[str]:
        """Names of the obstacles that a box touches, or nearly touches, where it is put down."""
        return self._book.beside(item) if place is Place.PALLET else frozenset({TABLES[place]})
