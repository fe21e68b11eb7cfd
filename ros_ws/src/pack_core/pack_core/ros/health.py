"""A node's health: what it refused and what is wrong, as one diagnostic status."""

from __future__ import annotations

from collections import Counter

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue


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
