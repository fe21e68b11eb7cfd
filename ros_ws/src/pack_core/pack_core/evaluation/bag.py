"""Reads bags; one that a kill cut off is read up to the cut.

Types come from the schemas in the bag, so a bag is readable wherever it is carried.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from mcap.exceptions import McapError
from mcap.records import Channel, Footer, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from pack_core.errors import BagError

UNREADABLE = (AnyReaderError, OSError, TypeError, ValueError, struct.error)
"""What rosbags raises on a bag that has no end, or is none."""
HEAD = 9
"""Bytes in front of a record's content: what it is (1), and its length (8)."""


@dataclass(frozen=True)
class Recorded:
    """A message of `topic`, recorded at simulated time `time_ns` [ns]."""

    topic: str
    time_ns: int
    message: Any


@dataclass(frozen=True)
class Bag:
    """What was read.

    Attributes:
        path: the bag's folder or file.
        messages: of the topics asked for, in order of time.
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
        topics = [item.topic for item in self.messages]
        return {topic: topics.count(topic) for topic in sorted(set(topics))}


def find_bag(path: Path) -> Path:
    """The bag in a run's folder, or `path` itself where it is a bag already.

    Raises:
        BagError: there is nothing like a bag.
    """
    for candidate in (path / "bag", path):
        if candidate.is_file() or (candidate / "metadata.yaml").is_file() or list(candidate.glob("*.mcap")):
            return candidate
    what = "has no metadata.yaml and no .mcap file" if path.is_dir() else "does not exist"
    raise BagError(f"{path} {what}; give a run's folder, a bag's folder or an .mcap file")


def read_bag(path: Path, topics: Collection[str] | None = None) -> Bag:
    """Read a run's folder, a bag's folder or an MCAP file.

    Args:
        path: what `find_bag` accepts.
        topics: names of those wanted; all if None.

    Raises:
        BagError: the bag is missing, or nothing in it is readable.
    """
    bag = find_bag(path)
    try:
        messages, is_cut = list(_read_finished(bag, topics)), False
    except UNREADABLE as error:
        messages, is_cut = _read_cut(_storage_file(bag, error), topics)
    return Bag(bag, tuple(sorted(messages, key=lambda item: item.time_ns)), is_cut)


def _read_finished(bag: Path, topics: Collection[str] | None) -> Iterator[Recorded]:
    with AnyReader([bag]) as reader:
        wanted = [item for item in reader.connections if topics is None or item.topic in topics]
        for connection, time_ns, data in reader.messages(wanted) if wanted else ():
            yield Recorded(connection.topic, time_ns, reader.deserialize(data, connection.msgtype))


def _storage_file(bag: Path, reason: Exception) -> Path:
    files = [bag] if bag.is_file() else sorted(bag.glob("*.mcap"))
    if len(files) != 1:
        raise BagError(f"{bag} is not readable as a bag: {reason}") from reason
    return files[0]


def _read_cut(file: Path, topics: Collection[str] | None) -> tuple[list[Recorded], bool]:
    """All messages of an MCAP file in front of the first broken record, and whether it has no end."""
    types = get_typestore(Stores.EMPTY)
    names: dict[int, str] = {}
    channels: dict[int, Channel] = {}
    messages: list[Recorded] = []
    is_cut = True
    for record in _whole_records(file.read_bytes()):
        if isinstance(record, Schema):
            names[record.id] = record.name
            types.register(get_types_from_msg(record.data.decode(), record.name))
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Message):
            channel = channels[record.channel_id]
            if topics is None or channel.topic in topics:
                message = types.deserialize_cdr(record.data, names[channel.schema_id])
                messages.append(Recorded(channel.topic, record.log_time, message))
        elif isinstance(record, Footer):
            is_cut = False
    if not channels:
        raise BagError(f"{file} holds no readable recording: not an MCAP file, or cut off at its very start")
    return messages, is_cut


def _whole_records(data: bytes) -> Iterator[Any]:
    end = len(MCAP0_MAGIC)
    while (follows := end + HEAD + int.from_bytes(data[end + 1 : end + HEAD], "little")) <= len(data):
        end = follows
    try:
        yield from StreamReader(BytesIO(data[:end])).records
    except (McapError, struct.error):
        return
