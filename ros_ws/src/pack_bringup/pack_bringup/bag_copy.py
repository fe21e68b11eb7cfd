"""Copies bags: a stretch of one, compressed, or a finished one of one that was cut off."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.errors import WriterError

from pack_core import stamps
from pack_core.errors import BagError
from pack_core.evaluation.raw_bag import read_raw_bag


@dataclass(frozen=True)
class Copied:
    """How many messages were copied, and whether the source was cut off."""

    messages: int
    was_cut: bool


def copy_bag(source: Path, target: Path, start: float = 0.0, end: float = float("inf")) -> Copied:
    """Copy what was recorded from `start` to `end` [s of simulated time], with index and metadata.

    Topics with one message only, such as the cell's description, are kept whatever their time.

    Raises:
        BagError: the source is not readable, or the target exists.
    """
    raw = read_raw_bag(source)
    counts = dict.fromkeys(raw.topics, 0)
    for item in raw.messages:
        counts[item.topic] += 1
    wanted = [
        item
        for item in raw.messages
        if counts[item.topic] == 1 or start <= stamps.to_seconds(item.time_ns) <= end
    ]
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
    return Copied(len(wanted), raw.is_cut)
