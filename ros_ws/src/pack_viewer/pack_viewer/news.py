"""What a page hears of its cell, whether the cell runs now or was recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol


@dataclass(frozen=True)
class News:
    """Messages that have come since the last look.

    Attributes:
        messages: by topic, oldest first; only the newest one of a topic of which no other counts.
        time: simulated time [s]; None while nothing has been heard.
        restarted: whether time went back, so that everything that was heard before is void.
    """

    messages: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    time: float | None = None
    restarted: bool = False

    def all(self, topic: str) -> Sequence[Any]:
        """The new messages of a topic, oldest first."""
        return self.messages.get(topic, ())

    def newest(self, topic: str) -> Any | None:
        """The newest message of a topic, if there is a new one."""
        found = self.messages.get(topic)
        return found[-1] if found else None


@dataclass(frozen=True)
class Topics:
    """What a page listens to.

    Attributes:
        states: topics of which only the newest message counts.
        events: topics of which every message counts.
        followed: those of the states whose course counts, such as what is plotted. After a jump in time they
            are handed out as they were on the way, others only as they are at its end.
    """

    states: tuple[str, ...]
    events: tuple[str, ...] = ()
    followed: tuple[str, ...] = ()

    def __add__(self, other: Topics) -> Topics:
        """These and those of `other`."""
        return Topics(self.states + other.states, self.events + other.events, self.followed + other.followed)

    @property
    def all(self) -> tuple[str, ...]:
        """Every topic."""
        return self.states + self.events


class NewsSource(Protocol):
    """Where news comes from."""

    def take(self) -> Sequence[News]:
        """What has come since the last call, oldest first: one, or several pieces after a jump in time."""


def seconds(message: Any) -> float:
    """Simulated time of a message's stamp [s]."""
    stamp = message.header.stamp
    return float(stamp.sec + 1e-9 * stamp.nanosec)
