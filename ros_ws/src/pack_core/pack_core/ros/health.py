"""A node's health: what it refused, what its callbacks raised that nobody foresaw, and what is wrong now."""

from __future__ import annotations

import time
import traceback
from collections import Counter
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

LOG_PERIOD = 1.0
"""Least time between two lines of the log about the same callback [s of wall clock]."""
IN_A_ROW = 20
"""Failures without a success in between after which a callback counts as broken."""


class Health:
    """What one node reports of itself in /diagnostics; any thread may write to it.

    Attributes:
        name: of the node.
        counts: how often something was refused or failed, by what it was.
        last: the reason of the last time, by what it was.
        faults: what is wrong now, in words, by a key with which it is taken back.
        values: figures to report, by name.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.counts: Counter[str] = Counter()
        self.last: dict[str, str] = {}
        self.faults: dict[str, str] = {}
        self.values: dict[str, str] = {}

    def count(self, what: str, reason: str) -> None:
        """Note that something was refused, and why."""
        self.last[what] = reason
        self.counts[what] += 1

    def status(self) -> DiagnosticStatus:
        """ERROR while a fault stands, WARN once something was refused, OK otherwise."""
        # Copies, because other threads write meanwhile.
        counts, faults = self.counts.copy(), self.faults.copy()
        level, message = DiagnosticStatus.OK, "ok"
        if counts:
            level = DiagnosticStatus.WARN
            message = "; ".join(f"{what}: {n} ({self.last[what]})" for what, n in counts.items())
        if faults:
            level, message = DiagnosticStatus.ERROR, "; ".join(faults.values())
        values = {**self.values, **{what: str(n) for what, n in counts.items()}}
        pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
        return DiagnosticStatus(level=level, name=self.name, message=message, values=pairs)


class Failures:
    """The unforeseen errors of one node; any thread may note one.

    Args:
        health: where they are counted, and where a callback that always fails is a fault.
        logger: gives the node's logger.

    Attributes:
        total: how many there were.
    """

    def __init__(self, health: Health, logger: Callable[[], Any]) -> None:
        self._health, self._logger = health, logger
        self._in_a_row: dict[str, int] = {}
        self._logged: dict[str, float] = {}
        self.total = 0

    def note(self, where: str, error: Exception) -> bool:
        """Count an error that was raised in the callback `where`, and name it at most once a second.

        Returns:
            Whether the callback counts as broken now: it has failed `IN_A_ROW` times.
        """
        self.total += 1
        self._health.count(f"failed {where}", repr(error))
        row = self._in_a_row[where] = self._in_a_row.get(where, 0) + 1
        if row >= IN_A_ROW:
            self._health.faults[_key(where)] = (
                f"{where} has failed {row} times in a row: {error!r}; restart the node (pack run, or pack up)"
            )
        now = time.monotonic()
        if now - self._logged.get(where, -LOG_PERIOD) >= LOG_PERIOD:
            self._logged[where] = now
            text = "".join(traceback.format_exception(error))
            count = self._health.counts[f"failed {where}"]
            self._logger().error(f"{where} failed ({count} times so far); the node goes on\n{text}")
        return row >= IN_A_ROW

    def passed(self, where: str) -> None:
        """Take back that the callback `where` is broken: it has returned."""
        if where in self._in_a_row:
            self._in_a_row.pop(where, None)
            self._health.faults.pop(_key(where), None)


def _key(where: str) -> str:
    return f"failed {where}"
