"""What the machine watches on the pallet and on table B: that all stands as it was put there."""

from __future__ import annotations

from pack_core.palletizing.cell import PALLET, REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.ports import Command, PalletObservation
from pallet_fsm.box_watch import Happening
from pallet_fsm.order_book import OrderBook
from pallet_fsm.scans.findings import Finding
from pallet_fsm.scans.look import PlaceLook, ScanConfig
from pallet_fsm.states import BEFORE_REGRASP, State
from pallet_fsm.transitions import Event


class PlaceWatch:
    """Has both places scanned, and tells what is not as it should be.

    Args:
        config: when places are scanned, and what counts as a change.
        cell: the cell's physical facts.
        book: what must stand where.
    """

    def __init__(self, config: ScanConfig, cell: PalletizingCell, book: OrderBook) -> None:
        blocks = {block.name: block for block in cell.furniture}
        self._pallet, self._table = (
            PlaceLook(name, blocks[name], cell, config) for name in (PALLET, REORIENTATION_TABLE)
        )
        self._book = book
        self._on_pallet: tuple[Finding, ...] = ()
        self._on_table: tuple[Finding, ...] = ()
        self._commands: list[Command] = []

    @property
    def is_looking(self) -> bool:
        """Whether a scan was asked for and has not come."""
        return self._pallet.is_awaited or self._table.is_awaited

    def observe(self, seen: PalletObservation) -> None:
        """Take note of scans that have come, and have places scanned."""
        carried = self._book.current.carried
        self._on_pallet = self._pallet.answer(seen, carried)
        self._on_table = self._table.answer(seen, carried)
        wanted = [self._pallet.ask(seen, self._book.on_pallet, carried)]
        if self._is_table_in_use:
            wanted.append(self._table.ask(seen, self._book.on_table, carried))
        self._commands += [command for command in wanted if command is not None]

    def commands(self) -> tuple[Command, ...]:
        """The commands since the last call."""
        commands, self._commands = tuple(self._commands), []
        return commands

    def change(self, state: State, time: float) -> Happening | None:
        """What is seen that is not as it should be, as an event that the state knows."""
        for look, where in ((self._pallet, "the pallet"), (self._table, "table B")):
            if look.is_late(time):
                return Event.HALTED, f"the scanner over {where} does not answer"
        if self._on_pallet:
            return Event.PLACE_CHANGED, f"seen on the pallet: {_words(self._on_pallet)}"
        found, self._on_table = self._on_table, ()  # it counts once: the machine goes on without the box
        if found:
            is_box = state in BEFORE_REGRASP and any(finding.box for finding in found)
            event = Event.BOX_CHANGED if is_box else Event.PLACE_CHANGED
            return event, f"seen on table B: {_words(found)}"
        return None

    def note_loss(self) -> None:
        """Strike the boxes off that no longer stand in their places on the pallet."""
        for finding in self._on_pallet:
            if finding.box:
                self._book.lose(finding.box, f"seen on the pallet: {finding}")

    @property
    def _is_table_in_use(self) -> bool:
        """Whether the box in work is on its way to table B, or stands there."""
        item = self._book.current
        is_on_its_way = item.handling is Handling.TABLE and item.X_TB is not None and item.approach is None
        return is_on_its_way or bool(self._book.on_table())


def _words(findings: tuple[Finding, ...]) -> str:
    return "; ".join(str(finding) for finding in findings)
