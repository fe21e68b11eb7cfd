"""Reads the serialised messages of a bag, also of one whose recording was killed.

Message types come from the schemas in the bag, so a bag can be read without the packages that define them.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, cast

from mcap.exceptions import McapError
from mcap.records import Channel, Footer, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.interfaces import ConnectionExtRosbag2, Qos
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from pack_core.errors import BagError

UNREADABLE = (AnyReaderError, OSError, TypeError, ValueError, struct.error)
"""Errors that rosbags raises on a bag that was not finished, or on something else."""
HEAD = 9
"""Bytes before the content of an MCAP record: its kind (1), and the length of its content (8)."""


@dataclass(frozen=True)
class Topic:
    """A topic of a bag; `type` is a name like `sensor_msgs/msg/JointState`."""

    name: str
    type: str
    offered_qos: tuple[Qos, ...] = ()


@dataclass(frozen=True)
class RawMessage:
    """A message of `topic` in CDR form, recorded at simulated time `time_ns` [ns]."""

    topic: str
    time_ns: int
    data: bytes


@dataclass(frozen=True)
class RawBag:
    """Content of a bag; `is_cut` is True if the recording ended without finishing the bag."""

    path: Path
    topics: dict[str, Topic]
    messages: tuple[RawMessage, ...]
    types: Typestore
    is_cut: bool


def find_bag(path: Path) -> Path:
    """The bag in a run's folder, or `path` itself where it is a bag already.

    Raises:
        BagError: there is no bag.
    """
    for candidate in (path / "bag", path):
        if candidate.is_file() or (candidate / "metadata.yaml").is_file() or list(candidate.glob("*.mcap")):
            return candidate
    what = "has no metadata.yaml and no .mcap file" if path.is_dir() else "does not exist"
    raise BagError(f"{path} {what}; give a run's folder, a bag's folder or an .mcap file")


def read_raw_bag(path: Path, topics: Collection[str] | None = None) -> RawBag:
    """Read a run's folder, a bag's folder or an MCAP file, in order of time.

    Args:
        path: a path that `find_bag` accepts.
        topics: names of the topics to read; None: all.

    Raises:
        BagError: the bag is missing, or nothing in it is readable.
    """
    bag = find_bag(path)
    try:
        return _read_finished(bag, topics)
    except UNREADABLE as error:
        return _read_cut(bag, _storage_files(bag, error), topics)


def _read_finished(bag: Path, topics: Collection[str] | None) -> RawBag:
    if bag.is_dir() and _are_files_missing_in_metadata(bag):
        raise ValueError("metadata.yaml does not name every .mcap file")
    with AnyReader([bag]) as reader:
        wanted = [item for item in reader.connections if topics is None or item.topic in topics]
        found = {
            item.topic: Topic(
                item.topic, item.msgtype, tuple(cast(ConnectionExtRosbag2, item.ext).offered_qos_profiles)
            )
            for item in wanted
        }
        records = reader.messages(wanted) if wanted else ()
        messages = tuple(RawMessage(item.topic, time_ns, bytes(data)) for item, time_ns, data in records)
        return RawBag(bag, found, messages, reader.typestore, is_cut=False)


def _are_files_missing_in_metadata(bag: Path) -> bool:
    """Whether the folder holds more files than its metadata.yaml names, as while a split bag is written."""
    if not (metadata := bag / "metadata.yaml").is_file():
        return False  # rosbags says so itself
    text = metadata.read_text()
    return any(file.name not in text for file in bag.glob("*.mcap"))


def _storage_files(bag: Path, reason: Exception) -> list[Path]:
    """The files of a bag in the order in which they were written: <bag>_0, <bag>_1, ..., then <bag>."""
    files = [bag] if bag.is_file() else sorted(bag.glob("*.mcap"), key=_number)
    if not files:
        raise BagError(f"{bag} is not readable as a bag: {reason}") from reason
    return files


def _number(file: Path) -> float:
    """Place of a file among those of its bag: the one without a number is being written and comes last."""
    number = file.stem.rpartition("_")[2]
    return int(number) if number.isdecimal() else float("inf")


def _read_cut(bag: Path, files: Sequence[Path], topics: Collection[str] | None) -> RawBag:
    """All messages of MCAP files before the first broken record of each."""
    types = get_typestore(Stores.EMPTY)
    topics_of: dict[str, Topic] = {}
    messages: list[RawMessage] = []
    is_cut = False
    for file in files:
        found, sent, is_whole = _read_file(file, types)
        topics_of |= {topic.name: topic for topic in found}
        messages += sent
        is_cut = is_cut or not is_whole
    if not topics_of:
        raise BagError(
            f"{files[0]} holds no readable recording: not an MCAP file, or cut off at its very start"
        )
    wanted = {name: topic for name, topic in topics_of.items() if topics is None or name in topics}
    kept = (item for item in messages if item.topic in wanted)
    return RawBag(bag, wanted, tuple(sorted(kept, key=lambda item: item.time_ns)), types, is_cut)


def _read_file(file: Path, types: Typestore) -> tuple[list[Topic], list[RawMessage], bool]:
    """Topics, messages, and whether the file ends as a finished one does; its types are registered."""
    names: dict[int, str] = {}
    channels: dict[int, Topic] = {}
    messages: list[RawMessage] = []
    is_whole = False
    for record in _whole_records(file.read_bytes()):
        if isinstance(record, Schema):
            names[record.id] = record.name
            types.register(get_types_from_msg(record.data.decode(), record.name))
        elif isinstance(record, Channel):
            qos = parse_qos(record.metadata.get("offered_qos_profiles", ""))
            channels[record.id] = Topic(record.topic, names[record.schema_id], tuple(qos))
        elif isinstance(record, Message):
            messages.append(RawMessage(channels[record.channel_id].name, record.log_time, record.data))
        elif isinstance(record, Footer):
            is_whole = True
    return list(channels.values()), messages, is_whole


def _whole_records(data: bytes) -> Iterator[Any]:
    end = len(MCAP0_MAGIC)
    # records follow each other, each with its length: stop at the first that the file does not hold whole
    while (follows := end + HEAD + int.from_bytes(data[end + 1 : end + HEAD], "little")) <= len(data):
        end = follows
    try:
        yield from StreamReader(BytesIO(data[:end])).records
    except (McapError, struct.error):
        return
