"""News from a recording, which can be held, gone through at any rate, and set to any time."""

from __future__ import annotations

import threading
import time
from bisect import bisect_right
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from pack_core import stamps
from pack_core.errors import BagError
from pack_evaluation.raw_bag import RawMessage, read_raw_bag
from pack_viewer.news import News, Topics

PIECE = stamps.to_ns(0.05)
"""After a jump, what lies on the way is handed out in pieces of so much simulated time [ns]: two for each
point of a plot."""
WAY = stamps.to_ns(60.0)
"""What is older than so much at the end of a jump is one piece [ns of simulated time]: plots end there."""


class RecordedNews:
    """Reads a recording as a running cell is heard; any thread may hold it or set its time.

    Args:
        path: a run's folder, a bag's folder or an MCAP file.
        topics: what is read; what the recording lacks is left out.
        start: simulated time to begin at [s], or the nearest that was recorded; None: the first moment.
        clock: wall clock that never jumps [s].

    Attributes:
        rate: simulated seconds a second of wall clock.
        is_paused: whether time stands still.

    Raises:
        BagError: the recording is missing or broken, or has none of the topics.
    """

    def __init__(
        self, path: Path, topics: Topics, *, start: float | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        raw = read_raw_bag(path, topics.all)
        if not raw.messages:
            raise BagError(f"{raw.path} has no message on {', '.join(topics.all)}")
        self._topics, self._raw, self._clock = topics, raw, clock
        self._tracks: dict[str, list[RawMessage]] = {name: [] for name in raw.topics}
        for message in raw.messages:
            self._tracks[message.topic].append(message)
        self._times = {name: [m.time_ns for m in track] for name, track in self._tracks.items()}
        self._read, self._handed_out = dict.fromkeys(self._tracks, 0), raw.messages[0].time_ns
        self.rate, self.is_paused = 1.0, False
        self._lock = threading.Lock()
        self._time = self.start if start is None else self._within(start)
        self._seen_at: float | None = None
        self._went_back = False

    @property
    def start(self) -> float:
        """First moment [s of simulated time]."""
        return stamps.to_seconds(self._raw.messages[0].time_ns)

    @property
    def end(self) -> float:
        """Last moment [s of simulated time]."""
        return stamps.to_seconds(self._raw.messages[-1].time_ns)

    @property
    def time(self) -> float:
        """Simulated time that is shown [s]."""
        return self._time

    def seek(self, time: float) -> None:
        """Go to a simulated time [s]."""
        with self._lock:
            target = self._within(time)
            self._went_back |= target < self._time
            self._time = target

    def _within(self, time: float) -> float:
        """The recorded moment that is nearest to a time [s]."""
        return min(max(time, self.start), self.end)

    def take(self) -> list[News]:
        """What was recorded since the time of the last call; from the beginning if time went back."""
        with self._lock:
            now = self._clock()
            if not self.is_paused and self._seen_at is not None:
                self._time = min(self._time + self.rate * (now - self._seen_at), self.end)
            self._seen_at = now
            restarted, self._went_back = self._went_back, False
            if restarted:
                self._read, self._handed_out = dict.fromkeys(self._tracks, 0), self._raw.messages[0].time_ns
            until = stamps.to_ns(self._time)
            pieces = list(self._on_the_way(until, restarted))
            self._handed_out = until
            newest = {name: self._until(name, until) for name in self._tracks}
            return [*pieces, News(newest, self._time, restarted and not pieces)]

    def _on_the_way(self, until_ns: int, restarted: bool) -> Iterator[News]:
        """Events and what is followed, from the time handed out last to shortly before another [ns]."""
        names = [name for name in (*self._topics.events, *self._topics.followed) if name in self._tracks]
        for end in range(max(self._handed_out + PIECE, until_ns - WAY), until_ns, PIECE):
            messages = {name: self._until(name, end) for name in names}
            if any(messages.values()):
                yield News(messages, stamps.to_seconds(end), restarted)
                restarted = False

    def _until(self, topic: str, time_ns: int) -> list[Any]:
        """Messages of a topic up to a time that were not handed out yet."""
        first, last = self._read[topic], bisect_right(self._times[topic], time_ns)
        if last <= first:
            return []
        self._read[topic] = last
        if topic in self._topics.states:
            first = last - 1
        kind = self._raw.topics[topic].type
        return [self._raw.types.deserialize_cdr(m.data, kind) for m in self._tracks[topic][first:last]]
