"""Reads the serialised messages of a bag, also of one whose recording was killed.

Message types come from the schemas in the bag, so a bag can be read without the packages that define them.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from pathlib import Path
from typing import NamedTuple, cast

from rosbags.highlevel import AnyReader
from rosbags.interfaces import ConnectionExtRosbag2, Qos
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from pack_core.bag_topic import Topic
from pack_core.errors import BagError, ConfigError
from pack_core.text.reader import load_yaml
from pack_evaluation.mcap_file import McapContent, read_mcap

DEFINITIONS = ("ros2msg", "ros2idl")
"""Encodings of definitions of ROS 2 messages in MCAP."""
DIGITS = 5
"""The most that the number of a bag's file has; longer ones are dates."""
ANEW_NS = 1_000_000_000
"""By which time must go back in a file for the simulator to have begun anew [ns]."""
MIXED = "time goes back within it: the simulator was started anew, and what came before and after is mixed"


class _Definition(NamedTuple):
    """Definition of a message type, as a recording has it."""

    name: str
    encoding: str
    data: bytes


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
        damaged: number of files, chunks, records and messages of unknown topics that could not be read.
        notes: which files and topics are missing or were left out, and why: a sentence each.
    """

    path: Path
    topics: dict[str, Topic]
    messages: tuple[RawMessage, ...]
    types: Typestore
    is_cut: bool
    damaged: int = 0
    notes: tuple[str, ...] = ()


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
    files = _Files([bag]) if bag.is_file() else _files_of(bag)
    return _read_mcap_files(bag, files, topics) if files.there else _read_other(bag, topics)


@dataclass(frozen=True)
class _Files:
    """The MCAP files of a bag, in order; how many are missing, and notes on these and on files left out."""

    there: list[Path]
    missing: int = 0
    notes: tuple[str, ...] = ()


def _files_of(bag: Path) -> _Files:
    """The files that metadata.yaml lists or, where it cannot tell, all that are there.

    A recorder that was killed may leave a list of its first files: numbered files that follow these count.
    """
    there = {file.name: file for file in sorted(bag.glob("*.mcap"))}
    if (listed := _listed_files(bag)) is None:
        return _numbered_files(bag, list(there.values()))
    missing = [name for name in listed if name not in there]
    if there and len(missing) == len(listed):
        raise BagError(
            f"{bag}: metadata.yaml lists {', '.join(missing)}, but there is {', '.join(there)}; give "
            "the file itself, or delete metadata.yaml"
        )
    common, last = max((_parts(Path(name)) for name in listed), key=lambda parts: parts[1])
    others = [name for name in there if name not in listed]
    following = (
        name for name in others if _parts(there[name])[0] == common and _parts(there[name])[1] > last
    )
    later = sorted(following, key=lambda name: _parts(there[name]))
    notes = [f"{name} is missing, which metadata.yaml lists" for name in missing]
    notes += [f"{name} follows those that metadata.yaml lists, and was read" for name in later]
    notes += [f"{name} was left out: metadata.yaml does not list it" for name in others if name not in later]
    files = [name for name in listed if name in there] + later
    return _Files([there[name] for name in files], len(missing), tuple(notes))


def _listed_files(bag: Path) -> list[str] | None:
    """Names of the MCAP files in metadata.yaml, each once; None if it is not there, is broken or has none.

    Raises:
        BagError: each message is compressed by itself, which is not read.
    """
    try:
        about = load_yaml(bag / "metadata.yaml")["rosbag2_bagfile_information"]
        mode, paths = about.get("compression_mode"), about["relative_file_paths"]
        # Old recorders put the bag's own folder in front.
        names = [Path(path).name for path in paths if path.endswith(".mcap")]
    except (ConfigError, AttributeError, LookupError, TypeError):
        return None
    if str(mode).upper() == "MESSAGE":
        raise BagError(
            f"{bag} was recorded with compression mode MESSAGE; allowed: FILE or none; `ros2 bag convert` "
            "writes it anew"
        )
    return list(dict.fromkeys(names)) or None


def _numbered_files(bag: Path, files: list[Path]) -> _Files:
    """Files without a list of them, by the numbers in their names: gaps are files that are missing."""
    parts = {file: _parts(file) for file in files}
    if len({name for name, _ in parts.values()}) > 1:
        raise BagError(
            f"{bag} has no metadata.yaml that lists its files, and {', '.join(file.name for file in files)} "
            "have no name in common: give one of them"
        )
    # The file without a number is being written and comes last.
    ordered = sorted(files, key=lambda file: parts[file][1])
    numbers = [int(number) for file in ordered if (number := parts[file][1]) < float("inf")]
    missing = sorted(set(range(max(numbers, default=-1))) - set(numbers))
    notes = tuple(f"{name}_{number}.mcap is missing" for number in missing for name in {parts[files[0]][0]})
    return _Files(ordered, len(missing), notes)


def _parts(file: Path) -> tuple[str, float]:
    """What the files of a bag have in common in their names, and the number of this one."""
    name, _, number = file.stem.rpartition("_")
    is_numbered = number.isascii() and number.isdecimal() and len(number) <= DIGITS
    return (name, int(number)) if is_numbered else (file.stem, float("inf"))


def _read_mcap_files(bag: Path, files: _Files, topics: Collection[str] | None) -> RawBag:
    contents = [_content_of(file) for file in files.there]
    left_out_of = [_left_out(content) for content in contents]
    definitions = [_definitions(*read) for read in zip(contents, left_out_of, strict=True)]
    types, broken = _typestore(tuple(dict.fromkeys(chain.from_iterable(definitions))))
    found: dict[str, Topic] = {}
    messages: list[RawMessage] = []
    is_cut, damaged = False, files.missing + broken
    notes = dict.fromkeys(files.notes)  # as a set that keeps its order
    for content, left_out in zip(contents, left_out_of, strict=True):
        notes |= {
            f"topic {content.channels[number].topic} was left out: {why}": None
            for number, why in left_out.items()
        }
        channels = _topics_of(content, types, left_out)
        found |= {topic.name: topic for topic in channels.values()}
        unknown = newest_ns = 0
        for item in content.messages:
            topic = channels.get(item.channel_id)
            if topic is not None:
                if item.log_time < newest_ns - ANEW_NS:
                    notes[MIXED] = None
                newest_ns = max(newest_ns, item.log_time)
                if topics is None or topic.name in topics:
                    messages.append(RawMessage(topic.name, item.log_time, item.data))
            elif item.channel_id not in left_out:
                unknown += 1
        is_cut, damaged = is_cut or not content.is_whole, damaged + content.damaged + unknown
    if not found:
        raise BagError(
            f"{files.there[0]} holds no readable recording: "
            + ("; ".join(notes) or "not an MCAP file, or cut off at its very start")
        )
    wanted = {name: topic for name, topic in found.items() if topics is None or name in topics}
    in_order = tuple(sorted(messages, key=lambda item: item.time_ns))
    return RawBag(bag, wanted, in_order, types, is_cut, damaged, tuple(notes))


def _left_out(content: McapContent) -> dict[int, str]:
    """Channels whose messages are none of ROS 2, or whose messages nobody could read, by number, and why."""
    found = {}
    for number, channel in content.channels.items():
        schema = content.schemas.get(channel.schema_id)
        if channel.message_encoding != "cdr":
            found[number] = f"its messages are '{channel.message_encoding}', not CDR"
        elif schema is not None and schema.encoding not in DEFINITIONS:
            found[number] = f"the recording holds no definition of {schema.name}" + (
                f", but '{schema.encoding}'" if schema.encoding else ""
            )
    return found


def _content_of(file: Path) -> McapContent:
    try:
        return read_mcap(file.read_bytes())
    except OSError as error:
        raise BagError(f"{file}: cannot be read: {error.strerror}") from error


def _definitions(content: McapContent, left_out: Collection[int]) -> list[_Definition]:
    """Definitions of the types whose messages are read."""
    wanted = {channel.schema_id for number, channel in content.channels.items() if number not in left_out}
    return [
        _Definition(schema.name, schema.encoding, schema.data)
        for schema in content.schemas.values()
        if schema.id in wanted
    ]


@lru_cache(maxsize=16)
def _typestore(definitions: tuple[_Definition, ...]) -> tuple[Typestore, int]:
    """The types that are defined, and how many of the definitions are damaged.

    Recordings of one cell have the same types, and so share what rosbags generates to read them: it takes as
    long as reading a short recording.
    """
    types, broken = get_typestore(Stores.EMPTY), 0
    for name, encoding, data in definitions:
        try:
            text = data.decode()
            types.register(
                get_types_from_idl(text) if encoding == "ros2idl" else get_types_from_msg(text, name)
            )
        except Exception:  # rosbags raises whatever its parser meets in a damaged definition
            broken += 1
    return types, broken


def _topics_of(content: McapContent, types: Typestore, left_out: Collection[int]) -> dict[int, Topic]:
    """The topics by their channels' numbers, as far as their types are known."""
    topics = {}
    for number, channel in content.channels.items():
        if number in left_out:
            continue
        its_schema = content.schemas.get(channel.schema_id)
        if its_schema is not None and its_schema.name in types.fielddefs:
            qos = _qos(channel.metadata.get("offered_qos_profiles", ""))
            topics[number] = Topic(channel.topic, its_schema.name, qos)
    return topics


@lru_cache(maxsize=64)
def _qos(profiles: str) -> tuple[Qos, ...]:
    """Profiles as a recording has them, YAML: most topics have the same, and rosbags reads them slowly."""
    try:
        return tuple(parse_qos(profiles))
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
