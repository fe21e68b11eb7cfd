"""What a node's callbacks raise that nobody foresaw: counted, written to the log, and told while it lasts."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from typing import Any

from pack_core.ros.health import Health

LOG_PERIOD = 1.0
"""Least time between two lines of the log about the same callback [s of wall clock]."""
IN_A_ROW = 20
"""Failures without a success in between after which a callback counts as broken."""


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
