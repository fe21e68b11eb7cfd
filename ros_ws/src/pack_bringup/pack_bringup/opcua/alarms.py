"""What is wrong with a cell, since when and why."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from datetime import datetime
from enum import Enum


class AlarmKind(Enum):
    """What an alarm is about, with its severity from 1 to 1000 (OPC UA part 5, 6.4.2)."""

    ARM_STOPPED = "ArmStopped", 900
    NODE_FAULT = "NodeFault", 800
    GOAL_FAILED = "GoalFailed", 600
    STEP_FAULT = "StepFault", 500
    REQUEST_FAILED = "RequestFailed", 300

    def __init__(self, label: str, severity: int) -> None:
        self.label, self.severity = label, severity


@dataclass(frozen=True)
class Alarm:
    """Something that is wrong, or was.

    Attributes:
        kind: what it is about.
        source: the node that it is about; empty where the kind says all.
        text: the reason in words.
        since: when it began, with its time zone.
        is_active: whether it is still so.
    """

    kind: AlarmKind
    source: str
    text: str
    since: datetime
    is_active: bool = True

    @property
    def name(self) -> str:
        """Names what is wrong; of two active alarms none has the same."""
        return f"{self.kind.label}.{self.source}" if self.source else self.kind.label

    @property
    def in_words(self) -> str:
        """Source and reason on a line."""
        return f"{self.source}: {self.text}" if self.source else self.text


class AlarmBoard:
    """The alarms that are active, in the order in which they began; any thread may put some.

    Attributes:
        begun: how many alarms have begun so far.
    """

    def __init__(self) -> None:
        self._active: dict[tuple[AlarmKind, str], Alarm] = {}
        self._changes: list[Alarm] = []
        self._lock = threading.Lock()
        self.begun = 0

    @property
    def active(self) -> tuple[Alarm, ...]:
        """Those that are active."""
        with self._lock:
            return tuple(self._active.values())

    def put(self, kind: AlarmKind, text: str, now: datetime, source: str = "") -> None:
        """Something is wrong for the reason `text`; where that is empty, it is not wrong any more."""
        with self._lock:
            before = self._active.get((kind, source))
            if not text:
                if before is not None:
                    del self._active[kind, source]
                    self._changes.append(replace(before, is_active=False))
                return
            if before is not None and before.text == text:
                return
            self.begun += before is None
            since = now if before is None else before.since
            alarm = self._active[kind, source] = Alarm(kind, source, text, since)
            self._changes.append(alarm)

    def take_changes(self) -> tuple[Alarm, ...]:
        """What has begun, ended or got another reason since the last call."""
        with self._lock:
            changes, self._changes = tuple(self._changes), []
        return changes
