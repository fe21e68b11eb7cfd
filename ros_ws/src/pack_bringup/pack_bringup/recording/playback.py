"""A recording as a stream of events in the order of simulated time, without ROS."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rosbags.interfaces import QosDurability
from rosbags.typesys.store import Typestore

from pack_core import stamps
from pack_core.bag_topic import Topic
from pack_core.errors import BagError
from pack_core.topics import CLOCK, CLOCK_RATE
from pack_evaluation.raw_bag import RawBag, RawMessage, read_raw_bag

TICK = stamps.to_ns(1.0 / CLOCK_RATE)
"""Between two ticks of a clock that is played [ns], as the simulator has it."""


@dataclass(frozen=True)
class Playback:
    """What will be played.

    Attributes:
        path: the bag's folder or file.
        topics: by name.
        types: definitions of their messages, as recorded.
        early: latched messages from before the first of the others, such as the cell's description.
        messages: the others in order of time.
        is_cut: whether the recording was cut off.
    """

    path: Path
    topics: dict[str, Topic]
    types: Typestore
    early: tuple[RawMessage, ...]
    messages: tuple[RawMessage, ...]
    is_cut: bool

    @property
    def start_ns(self) -> int:
        """Simulated time of the first message [ns]."""
        return self.messages[0].time_ns

    @property
    def end_ns(self) -> int:
        """Simulated time of the last message [ns]."""
        return self.messages[-1].time_ns

    @property
    def duration(self) -> float:
        """From the first to the last message [s of simulated time]."""
        return stamps.to_seconds(self.end_ns - self.start_ns)

    def events(self, *, clock: bool) -> Iterator[RawMessage | int]:
        """Messages, and ticks of the clock as their time [ns] where it is wanted, in order of time.

        A tick comes before the messages of its time.
        """
        tick = self.start_ns
        for message in self.messages:
            while clock and tick <= message.time_ns:
                yield tick
                tick += TICK
            yield message


def stretch(raw: RawBag) -> tuple[int, int] | None:
    """From when to when a recording is played as a whole [ns]; None: it has nothing to play.

    Latched messages from before, such as the cell's description, do not count.
    """
    topics = {name: topic for name, topic in raw.topics.items() if _is_played(topic)}
    messages = [item for item in raw.messages if item.topic in topics]
    first = _first(messages, topics, 0.0)
    return None if first is None else (first, messages[-1].time_ns)


def load_playback(
    path: Path, topics: Collection[str] | None = None, heard: Collection[str] = (), *, start: float = 0.0,
    end: float = float("inf"),
) -> Playback:  # fmt: skip
    """Read what is to be played from a run's folder, a bag's folder or an MCAP file.

    Args:
        path: the recording.
        topics: those wanted; if None, and none is heard, all but /clock and the events of services.
        heard: topics of which those that were recorded are wanted, too: what a node listens to depends on its
            cell's configuration.
        start: what was recorded before is left out, but for latched topics [s of simulated time].
        end: what was recorded after is left out [s of simulated time].

    Raises:
        BagError: the bag is missing or broken, lacks a topic, or has nothing to play.
    """
    raw = read_raw_bag(path)
    wanted = {*(topics or ()), *(name for name in heard if name in raw.topics)}
    if topics is None and not heard:
        wanted = {name for name in raw.topics if _is_played(raw.topics[name])}
    if CLOCK in wanted:
        raise BagError(f"{CLOCK} is not played from the recording; --clock sends one that keeps to --rate")
    if missing := sorted(wanted - set(raw.topics)):
        there = ", ".join(sorted(set(raw.topics) - {CLOCK}))
        raise BagError(f"{raw.path} has no topic {', '.join(missing)}; it has {there}")
    if not wanted:
        raise BagError(f"{raw.path} has none of {', '.join(sorted(heard))}")
    chosen = {name: raw.topics[name] for name in sorted(wanted)}
    within = [
        item for item in raw.messages if item.topic in chosen and stamps.to_seconds(item.time_ns) <= end
    ]
    first_ns = _first(within, chosen, start)
    if first_ns is None and within and all(is_latched(chosen[m.topic]) for m in within):
        raise BagError(
            f"{raw.path} has of {', '.join(chosen)} only what is sent once; what the node works on was not "
            "recorded, as pictures are not without recorder.pictures"
        )
    if first_ns is None:
        raise BagError(f"{raw.path} has no message to play on {', '.join(chosen)} from {start} s to {end} s")
    early = tuple(m for m in within if m.time_ns < first_ns and is_latched(chosen[m.topic]))
    rest = tuple(m for m in within if m.time_ns >= first_ns)
    return Playback(raw.path, chosen, raw.types, early, rest, raw.is_cut)


def _is_played(topic: Topic) -> bool:
    """Whether a topic is played unless others are asked for: no clock, and not what a service has told.

    The latter are among the topics that ROS 2 hides, by an underscore in front of a part of their name.
    """
    return topic.name != CLOCK and "/_" not in topic.name


def _first(messages: Sequence[RawMessage], topics: Mapping[str, Topic], start: float) -> int | None:
    """When the first message from `start` [s] on was recorded that is not latched [ns]."""
    return next(
        (
            m.time_ns
            for m in messages
            if stamps.to_seconds(m.time_ns) >= start and not is_latched(topics[m.topic])
        ),
        None,
    )


def is_latched(topic: Topic) -> bool:
    """Whether a late listener to a recorded topic was sent its newest message."""
    return any(qos.durability is QosDurability.TRANSIENT_LOCAL for qos in topic.offered_qos)
