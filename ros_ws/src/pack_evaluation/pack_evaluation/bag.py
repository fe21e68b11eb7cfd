"""Reads the messages of a bag as Python objects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pack_evaluation.raw_bag import read_raw_bag


@dataclass(frozen=True)
class Recorded:
    """A message of `topic`, recorded at simulated time `time_ns` [ns]."""

    topic: str
    time_ns: int
    message: Any


@dataclass(frozen=True)
class Bag:
    """The messages that were read from a bag.

    Attributes:
        path: the bag's folder or file.
        messages: messages of the requested topics, in order of time.
        is_cut: whether the recording ended without finishing the bag.
    """

    path: Path
    messages: tuple[Recorded, ...]
    is_cut: bool

    def of(self, topic: str) -> list[Any]:
        """The messages of one topic, in order."""
        return [item.message for item in self.messages if item.topic == topic]

    def counts(self) -> dict[str, int]:
        """Messages by topic."""
        return dict(sorted(Counter(item.topic for item in self.messages).items()))


def read_bag(path: Path, topics: Collection[str] | None = None) -> Bag:
    """Read a run's folder, a bag's folder or an MCAP file.

    Args:
        path: the run's folder, bag's folder or MCAP file.
        topics: names of the topics to read; None: all.

    Raises:
        BagError: the bag is missing, or nothing in it is readable.
    """
    raw = read_raw_bag(path, topics)
    messages = tuple(
        Recorded(item.topic, item.time_ns, raw.types.deserialize_cdr(item.data, raw.topics[item.topic].type))
        for item in raw.messages
    )
    return Bag(raw.path, messages, raw.is_cut)
