"""Runs the machine's states as legs, one after the other, and knows what each of them may touch."""

from __future__ import annotations

from pack_core.palletizing.cell import PalletizingCell
from pack_core.rotations import Array
from pallet_fsm.blended_moves import BlendedMoves
from pallet_fsm.mover import Mover
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.ports import MoveArm, Observation
from pallet_fsm.profile import Profile
from pallet_fsm.states import State
from pallet_fsm.surroundings import REORIENTATION_TABLE
from pallet_fsm.thesis_moves import ThesisMoves
from pallet_fsm.transitions import Event
from pallet_fsm.work_item import WorkItem


class LegRunner:
    """The arm's side of the machine.

    Args:
        profile: how states become moves.
        book: the order's boxes.
        cell: the cell's physical facts.
        config: parameters.

    Attributes:
        approach: direction in which the tool held the box at the last leg's end, at table B.
    """

    def __init__(
        self, profile: Profile, book: OrderBook, cell: PalletizingCell, config: PalletizerConfig
    ) -> None:
        self._book = book
        self._mover = Mover(profile, config.mover)
        self._moves = (
            BlendedMoves(cell, config.poses, config.blended)
            if profile.is_blended
            else ThesisMoves(cell, config.poses, config.thesis)
        )
        self._touched: frozenset[str] = frozenset()
        self.approach: Array | None = None

    @property
    def reason(self) -> str:
        """Of the last trouble; empty if there was none since the leg began."""
        return self._mover.reason

    def stands_at(self, *names: str) -> None:
        """What the hand or its box touches now."""
        self._touched = frozenset(names)

    def follow(self, state: State, item: WorkItem, seen: Observation) -> Event | MoveArm | None:
        """Begin a leg in `state` or follow the one that runs."""
        if self._mover.leg is None:
            return self._begin(state, item, seen)
        leg = self._mover.leg
        outcome = self._mover.follow(seen.motion, state)
        if outcome is Event.REACHED and self._mover.leg is None:
            self.approach = leg.approach
            self._touched = self._touched_at(leg.end, item)
        return outcome

    def _begin(self, state: State, item: WorkItem, seen: Observation) -> Event | MoveArm:
        target: WorkItem | None = item
        if state in (State.RETREAT, State.RETURN):
            target = self._book.upcoming if item.is_finished else None
        legs = [
            (leg, self._touched | self._touched_at(leg.end, target))
            for leg in self._moves.legs(state, target, seen.motion.X_WT)
        ]
        return self._mover.begin(legs, item.carried, self._book.obstacles(), seen.time)

    def _touched_at(self, end: State, item: WorkItem | None) -> frozenset[str]:
        """Names of what the hand or its box touches, or nearly, where a leg ends."""
        if item is None:
            return frozenset()
        if end in (State.GRASP, State.REGRASP):
            return frozenset({item.name})
        if end is State.RELEASE_TABLE:
            return frozenset({item.name, REORIENTATION_TABLE})
        if end in (State.PRE_DEPOSIT, State.DEPOSIT):
            return self._book.beside(item) | {item.name}
        return frozenset()
