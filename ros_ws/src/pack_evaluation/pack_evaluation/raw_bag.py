"""Reads the serialised messages of a bag, also of one whose recording was killed.

Message types come from the schemas in the bag, so a bag can be read without the packages that define them.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from mcap.records import Channel, Schema
from rosbags.highlevel import AnyReader
from rosbags.interfaces import ConnectionExtRosbag2, Qos
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from pack_core.errors import BagError
from pack_evaluation.mcap_file import McapContent, read_mcap


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
    """Content of a bag.

    Attributes:
        path: the bag's folder or file.
        topics: those that were read, by name.
        messages: in order of time.
        types: definitions of their messages.
        is_cut: whether the recording ended without finishing the bag.
        damaged: number of chunks, records and messages of unknown topics that could not be read.
    """

    path: Path
    topics: dict[str, Topic]
    messages: tuple[RawMessage, ...]
    types: Typestore
    is_cut: bool
    damaged: int = 0


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
    files = [bag] if bag.is_file() else sorted(bag.glob("*.mcap"), key=_number)
    return _read_mcap_files(bag, files, topics) if files else _read_other(bag, topics)


def _number(file: Path) -> float:
    """Place of a file among those of its bag: the one without a number is being written and comes last."""
    number = file.stem.rpartition("_")[2]
    return int(number) if number.isdecimal() else float("inf")


def _read_mcap_files(bag: Path, files: list[Path], topics: Collection[str] | None) -> RawBag:
    types = get_typestore(Stores.EMPTY)
    found: dict[str, Topic] = {}
    messages: list[RawMessage] = []
    is_cut, damaged = False, 0
    for file in files:
        try:
            content = read_mcap(file.read_bytes())
        except OSError as error:
            raise BagError(f"{file}: cannot be read: {error.strerror}") from error
        channels = _topics_of(content, types)
        found |= {topic.name: topic for topic in channels.values()}
        unknown = 0
        for item in content.messages:
            if item.channel_id in channels:
                messages.append(RawMessage(channels[item.channel_id].name, item.log_time, item.data))
            else:
                unknown += 1
        is_cut, damaged = is_cut or not content.is_whole, damaged + content.damaged + unknown
    if not found:
        raise BagError(
            f"{files[0]} holds no readable recording: not an MCAP file, or cut off at its very start"
        )
    wanted = {name: topic for name, topic in found.items() if topics is None or name in topics}
    kept = (item for item in messages if item.topic in wanted)
    return RawBag(bag, wanted, tuple(sorted(kept, key=lambda item: item.time_ns)), types, is_cut, damaged)


def _topics_of(content: McapContent, types: Typestore) -> dict[int, Topic]:
    """The topics by their channels' numbers, as far as their types can be read, which are registered."""
    for schema in content.schemas.values():
        try:
            _register(schema, types)
        except Exception:  # rosbags raises whatever its parser meets in a damaged definition
            content.damaged += 1
    topics = {}
    for number, channel in content.channels.items():
        its_schema = content.schemas.get(channel.schema_id)
        if its_schema is not None and its_schema.name in types.fielddefs:
            topics[number] = Topic(channel.topic, its_schema.name, _qos(channel))
    return topics


def _register(schema: Schema, types: Typestore) -> None:
    text = schema.data.decode()
    is_idl = schema.encoding == "ros2idl"
    types.register(get_types_from_idl(text) if is_idl else get_types_from_msg(text, schema.name))


def _qos(channel: Channel) -> tuple[Qos, ...]:
    try:
        return tuple(parse_qos(channel.metadata.get("offered_qos_profiles", "")))
    except Exception:  # as above: a damaged profile is as good as none
        return ()


def _read_other(bag: Path, topics: Collection[str] | None) -> RawBag:
    """A bag of another storage, such as SQLite or a compressed file, by rosbags alone."""
    try:
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
    except Exception as error:  # its own errors, and those of every codec and parser below it
        raise BagError(f"{bag} is not readable as a bag: {error}") from error
