"""Starts nodes again that died, and gives up on one that keeps dying."""

from __future__ import annotations

import time
from collections.abc import Callable

from pack_bringup.graph.processes import ProcessGroup

MOST = 3
"""Restarts of one node within `SPAN`; one that dies once more is left dead, as it would die again."""
SPAN = 60.0
"""Over which restarts are counted [s of wall clock]."""


class Restarts:
    """Watches a group of processes.

    Args:
        group: the processes.
        say: is told what was done, in a sentence.
        clock: wall clock [s].
    """

    def __init__(
        self, group: ProcessGroup, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._group, self._say, self._clock = group, say, clock
        self._times: dict[str, list[float]] = {}
        self._given_up: set[str] = set()

    def look(self) -> None:
        """Start again what has died since the last look; a process that ended in order stays ended."""
        for name, code in self._group.exit_codes.items():
            if code != 0 and name not in self._given_up:
                self._restart(name, code)

    def _restart(self, name: str, code: int) -> None:
        now = self._clock()
        times = self._times[name] = [at for at in self._times.get(name, []) if now - at < SPAN]
        if len(times) >= MOST:
            self._given_up.add(name)
            self._say(
                f"node '{name}' died again (exit code {code}), {MOST} restarts in a minute did not help: it "
                "stays ended; its last log lines say why"
            )
            return
        times.append(now)
        self._group.restart(name)
        self._say(f"node '{name}' died (exit code {code}) and was started again, restart {len(times)}")
