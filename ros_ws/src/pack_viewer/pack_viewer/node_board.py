"""The health of every node, as /diagnostics tells it and as its silence does."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

from pack_viewer.event_log import EventLog
from pack_viewer.fragments import GREEN, ORANGE, RED, signed_list

SILENT = 4.0
"""A node that reports once a second counts as silent after this long [s of wall clock]."""
WARNED = 30.0
"""A warning is shown for this long after it last changed [s of wall clock]."""
OK, WARN = 0, 1
"""Levels of diagnostic_msgs/DiagnosticStatus; those above are errors."""


@dataclass
class NodeHealth:
    """The last report of a node, when it came, and when its message last changed [s of wall clock]."""

    level: int
    message: str
    heard_at: float
    changed_at: float


class NodeBoard:
    """Keeps the last report of every node.

    Args:
        log: is told of changes.
        watched: nodes whose silence is a fault; others, such as the client of a goal, are not shown once they
            are silent. None: silence means nothing, as in a recording, which may be held.
        clock: wall clock that never jumps [s].
    """

    def __init__(
        self, log: EventLog, watched: Collection[str] | None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._log, self._watched, self._clock = log, watched, clock
        self._nodes: dict[str, NodeHealth] = {}

    def take(self, message: Any, time: float | None = None) -> None:
        """Note a message of /diagnostics that came at simulated time `time` [s], where that is known.

        The log is told of what is new; that the same was refused once more shows on the board only.
        """
        for status in message.status:
            level, now = level_of(status.level), self._clock()
            before = self._nodes.get(status.name)
            if level > OK and (before is None or _kind(before.message) != _kind(status.message)):
                self._log.add(
                    f"{status.name}: {status.message}", "error" if level > WARN else "warning", time
                )
            changed_at = before.changed_at if before and before.message == status.message else now
            self._nodes[status.name] = NodeHealth(level, status.message, now, changed_at)

    def forget(self) -> None:
        """As if no node had reported yet."""
        self._nodes.clear()

    @property
    def silent(self) -> list[str]:
        """Watched nodes that have reported before and do so no longer."""
        return [name for name in self._nodes if name in (self._watched or ()) and not self._is_heard(name)]

    @property
    def _shown(self) -> dict[str, NodeHealth]:
        """All but those that are not watched and have gone."""
        watched = self._nodes if self._watched is None else self._watched
        return {name: node for name, node in self._nodes.items() if name in watched or self._is_heard(name)}

    def _is_heard(self, name: str) -> bool:
        return self._clock() - self._nodes[name].heard_at <= SILENT

    @property
    def has_fault(self) -> bool:
        """Whether a node reports an error or has fallen silent."""
        return bool(self.silent) or any(node.level > WARN for node in self._shown.values())

    def html(self) -> str:
        """A line for each node that has something to say, and one for all that are well.

        A node counts what it refused for as long as it runs; it is well again once nothing was for a while.
        """
        silent, rows, well = self.silent, [], []
        for name, node in sorted(self._shown.items()):
            if name in silent:
                rows.append(("✕", RED, f"{name}: silent for {self._clock() - node.heard_at:.0f} s"))
            elif node.level == OK or (node.level == WARN and self._clock() - node.changed_at > WARNED):
                well.append(name)
            else:
                sign, colour = ("✕", RED) if node.level > WARN else ("▲", ORANGE)
                rows.append((sign, colour, f"{name}: {node.message}"))
        if well:
            rows.append(("✓", GREEN, ", ".join(well)))
        return signed_list(rows, "no node has reported yet")


def _kind(message: str) -> str:
    """What a message says but for its numbers, such as how often something was refused."""
    return re.sub(r"\d+(\.\d+)?", "#", message)


def level_of(level: bytes | int) -> int:
    """A diagnostic level, which ROS hands out as a byte string and recordings as a number."""
    return level[0] if isinstance(level, bytes) else int(level)
