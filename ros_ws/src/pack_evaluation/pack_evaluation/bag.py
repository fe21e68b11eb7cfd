"""Reads the messages of a bag as Python objects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pack_core import stamps
from pack_core.errors import BagError, ConfigError
from pack_core.rotations import Array
from pack_core.text.json_text import parse_json
from pack_evaluation.raw_bag import RawBag, RawMessage, read_raw_bag


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
        damaged: number of files, pieces and messages that could not be read.
        notes: which files and topics are missing or were left out, and why: a sentence each.
    """

    path: Path
    messages: tuple[Recorded, ...]
    is_cut: bool
    damaged: int = 0
    notes: tuple[str, ...] = ()

    def reason(self, otherwise: str) -> str:
        """Why something may be missing in the bag: what was left out, if anything was."""
        return "; ".join(self.notes) or otherwise

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
    return decoded(read_raw_bag(path, topics))


def decoded(raw: RawBag) -> Bag:
    """The messages of a bag that was read, as Python objects."""
    messages = [message for item in raw.messages if (message := _decoded(item, raw)) is not None]
    damaged = raw.damaged + len(raw.messages) - len(messages)
    return Bag(raw.path, tuple(messages), raw.is_cut, damaged, raw.notes)


def seconds(stamp: Any) -> float:
    """A recorded `Time` or `Duration` [s]."""
    return stamps.to_seconds(stamp.sec * stamps.NS_PER_S + stamp.nanosec)


def times_of(messages: Sequence[Any]) -> Array:
    """The stamps of recorded messages with a header `(n,)` [s]."""
    return np.array([seconds(message.header.stamp) for message in messages])


def result_in(text: str, path: Path) -> dict[str, Any]:
    """The fields of a goal's result, which a node published as JSON.

    Raises:
        BagError: the text is no JSON object.
    """
    try:
        result = parse_json(text, str(path))
    except ConfigError as error:
        raise BagError(f"the goal's result is broken: {error}") from error
    if not isinstance(result, dict):
        raise BagError(f"{path}: the goal's result is a {type(result).__name__}; allowed: keys and values")
    return result


@contextmanager
def fitting(path: Path) -> Iterator[None]:
    """Raise a BagError where recorded messages cannot be put together.

    Messages of a damaged recording may be readable, each for itself, and still hold lists of different
    lengths, names that no other message knows, or results without the fields that are read.
    """
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise BagError(f"{path}: what was recorded does not fit together: {error!r}") from error


def _decoded(item: RawMessage, raw: RawBag) -> Recorded | None:
    """A message as an object; None where its bytes are damaged."""
    try:
        message = raw.types.deserialize_cdr(item.data, raw.topics[item.topic].type)
    except Exception:  # rosbags raises whatever its generated code meets: struct, index, Unicode errors
        return None
    return Recorded(item.topic, item.time_ns, message)
