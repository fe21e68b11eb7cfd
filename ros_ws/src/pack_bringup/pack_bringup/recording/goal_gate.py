"""Chooses, from everything that a cell sends, what is recorded of its goals."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass, replace

from pack_core import stamps

BEFORE = stamps.to_ns(2.0)
"""How long before a goal the recording begins [ns of wall clock]. It also covers the time until the recorder
hears of the goal, which is at most 0.1 s."""
AFTER = stamps.to_ns(2.0)
"""How long after a goal the recording goes on, for its result and what other nodes say of it [ns of wall
clock]; `pack demo` waits as long before it stops the nodes."""


@dataclass(frozen=True)
class Sent:
    """A message as it was received.

    Attributes:
        sent_ns: when it was sent [ns of wall clock].
        topic: its name.
        time_ns: its stamp in the bag [ns of simulated time].
        data: its CDR form.
    """

    sent_ns: int
    topic: str
    time_ns: int
    data: bytes


class GoalGate:
    """Lets through what is sent from `BEFORE` a goal until `AFTER` it.

    The newest message of each latched topic is kept: where it was sent earlier and the bag does not have it
    yet, it is let through first, stamped as the earliest of the others. So what a goal depends on, such as
    the description of the scene, is in the bag whenever it was sent.

    Args:
        latched: names of the latched topics.

    Attributes:
        is_goal: whether a goal is in progress.
    """

    def __init__(self, latched: Collection[str]) -> None:
        self.is_goal = False
        self._latched = frozenset(latched)
        self._newest: dict[str, Sent] = {}
        self._written: dict[str, Sent] = {}
        self._waiting: deque[Sent] = deque()
        self._closes_ns = -1  # before every time

    def set_goal(self, is_goal: bool, now_ns: int) -> list[Sent]:
        """A goal has begun or ended at `now_ns` [ns of wall clock]; returns what is to be recorded now."""
        if is_goal == self.is_goal:
            return []
        was_open, self.is_goal = self._is_open(now_ns), is_goal
        if not is_goal:
            self._closes_ns = now_ns + AFTER
        return [] if was_open else self._begin()

    def take(self, item: Sent) -> list[Sent]:
        """Take in the next message in the order of sending; returns what is to be recorded now."""
        if item.topic in self._latched:
            self._newest[item.topic] = item
        if self._is_open(item.sent_ns):
            return [self._let_through(item)]
        self._waiting.append(item)
        while item.sent_ns - self._waiting[0].sent_ns > BEFORE:
            self._waiting.popleft()
        return []

    def _is_open(self, now_ns: int) -> bool:
        return self.is_goal or now_ns <= self._closes_ns

    def _begin(self) -> list[Sent]:
        """What was sent shortly before a goal, and in front of it what is latched since earlier."""
        waiting = list(self._waiting)
        self._waiting.clear()
        recent = {item.topic for item in waiting}
        earlier = [
            # Its own stamp may be hours earlier: whoever plays the bag would wait for as long.
            replace(item, time_ns=waiting[0].time_ns if waiting else item.time_ns)
            for topic, item in self._newest.items()
            if topic not in recent and self._written.get(topic) is not item
        ]
        self._written |= {item.topic: self._newest[item.topic] for item in earlier}
        return [*earlier, *map(self._let_through, waiting)]

    def _let_through(self, item: Sent) -> Sent:
        if item.topic in self._latched:
            self._written[item.topic] = item
        return item
