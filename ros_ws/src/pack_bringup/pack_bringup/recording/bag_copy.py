"""Copies bags: a part of one, compressed, or a whole one of one that was cut off."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.errors import WriterError

from pack_bringup.recording.playback import is_latched
from pack_core import stamps
from pack_core.errors import BagError
from pack_evaluation.raw_bag import read_raw_bag


@dataclass(frozen=True)
class Copied:
    """How many messages were copied, whether the source was cut off, and how much of it was not readable.

    `notes` are sentences about what is missing or was left out.
    """

    messages: int
    was_cut: bool
    damaged: int
    notes: tuple[str, ...]


def copy_bag(
    source: Path,
    target: Path,
    *,
    start: float = 0.0,
    end: float = float("inf"),
    topics: Collection[str] | None = None,
) -> Copied:
    """Copy what was recorded from `start` to `end` [s of simulated time], with index and metadata.

    Latched messages from before `start`, such as the cell's description, are copied too.

    Raises:
        BagError: the source is not readable, the target exists, or the end comes before the start.
    """
    if end < start:
        raise BagError(f"from {start:g} s to {end:g} s; allowed: an end after the start")
    raw = read_raw_bag(source, topics)
    latched = {name for name, topic in raw.topics.items() if is_latched(topic)}
    first = {name: 0.0 if name in latched else start for name in raw.topics}
    wanted = [item for item in raw.messages if first[item.topic] <= stamps.to_seconds(item.time_ns) <= end]
    try:
        writer = Writer(target, version=9, storage_plugin=StoragePlugin.MCAP)
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        with writer:
            connections = {
                topic.name: writer.add_connection(
                    topic.name, topic.type, typestore=raw.types, offered_qos_profiles=topic.offered_qos
                )
                for topic in raw.topics.values()
            }
            for item in wanted:
                writer.write(connections[item.topic], item.time_ns, item.data)
    except (OSError, WriterError) as error:
        raise BagError(f"cannot write {target}: {error}; give a folder that does not exist yet") from error
    return Copied(len(wanted), raw.is_cut, raw.damaged, raw.notes)
