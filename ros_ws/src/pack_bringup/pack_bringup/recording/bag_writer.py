"""Writes one bag as several compressed files: rosbag2 format 9, MCAP with zstd chunks."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, cast

import yaml
import zstandard
from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.typesys.store import Typestore

from pack_core.bag_topic import Topic
from pack_core.text.yaml_text import parse_yaml

INFORMATION = "rosbag2_bagfile_information"


class BagWriter:
    """A bag's folder that is being written.

    The file at hand is `<folder>.mcap`. Once it has reached `split_size` it becomes `<folder>_0.mcap`,
    `<folder>_1.mcap` and so on, and another is begun. A bag that was never split has the one file alone.

    Args:
        path: the folder, which must not exist yet.
        topics: what will be written.
        types: definitions of their messages.
        split_size: size of a file at which the next one is begun [byte].

    Raises:
        WriterError: the folder exists.
        OSError: it cannot be made.
    """

    def __init__(self, path: Path, topics: Iterable[Topic], types: Typestore, split_size: float) -> None:
        self.path = path
        self._topics, self._types, self._split_size = tuple(topics), types, split_size
        self._finished: dict[str, Any] | None = None  # what metadata.yaml says about the files before
        self._finished_size = 0
        self._writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self._writer.open()
        self._storage.compressor = _compressor()
        self._connections = self._connect()

    @property
    def size(self) -> int:
        """Size of all files so far, without the chunk at hand [byte]."""
        return self._finished_size + self._storage.bio.tell()

    @property
    def is_there(self) -> bool:
        """Whether the file at hand still stands where it was made; nobody could read a removed one."""
        with suppress(OSError):
            return os.path.samestat(self._storage.path.stat(), os.fstat(self._storage.bio.fileno()))
        return False

    def write(self, topic: str, time_ns: int, data: bytes) -> None:
        """Write a message in CDR form, stamped with simulated time [ns]."""
        self._writer.write(self._connections[topic], time_ns, data)

    def flush(self) -> None:
        """Close the chunk at hand, so that a reader finds it whole, and see it to the disk."""
        storage = self._storage
        if not storage.chunk.msgs:
            return
        storage.close_chunk()
        storage.bio.flush()
        os.fdatasync(storage.bio.fileno())
        if storage.bio.tell() >= self._split_size:
            self._begin_next_file()

    def close(self) -> None:
        """Write the index of the file at hand, and metadata.yaml about all files."""
        if self._finished:
            self._finish_file()
            text = yaml.safe_dump({INFORMATION: self._finished}, sort_keys=False)
            part = self._writer.metapath.with_suffix(".part")
            part.write_text(text)
            part.replace(self._writer.metapath)
        else:
            self._writer.close()

    def abort(self) -> None:
        """Close the file at hand as it is; what was flushed is readable."""
        with suppress(OSError):
            self._writer.abort()

    @property
    def _storage(self) -> McapWriter:
        return cast(McapWriter, self._writer.storage)

    def _connect(self) -> dict[str, Connection]:
        return {
            topic.name: self._writer.add_connection(
                topic.name, topic.type, typestore=self._types, offered_qos_profiles=topic.offered_qos
            )
            for topic in self._topics
        }

    def _finish_file(self) -> None:
        """Give the file at hand its number and its index, and keep what rosbags says about it."""
        storage = self._storage
        number = len(self._finished["files"]) if self._finished else 0
        numbered = self.path / f"{self.path.name}_{number}.mcap"
        storage.path.rename(numbered)
        storage.path = numbered  # the name that `close` writes into the metadata
        self._writer.close()
        self._finished_size += numbered.stat().st_size
        # It names this file alone. While it stood there, readers would leave out the files that follow.
        path = self._writer.metapath
        metadata = parse_yaml(path.read_text(), str(path))[INFORMATION]
        self._finished = merged_metadata(self._finished, metadata) if self._finished else metadata
        path.unlink()

    def _begin_next_file(self) -> None:
        self._finish_file()
        writer = self._writer
        # The same writer with a new file; a new writer would refuse the folder, because it exists.
        writer.storage = McapWriter(self.path, CompressionMode.STORAGE)
        self._storage.compressor = _compressor()
        writer.connections, writer.counts, writer.added_types = [], {}, set()
        writer.min_timestamp, writer.max_timestamp = 2**63 - 1, 0
        self._connections = self._connect()


def _compressor() -> Callable[[bytes], bytes]:
    """Zstandard with a checksum, which rosbags leaves out: without it a flipped bit becomes a wrong value."""
    compress: Callable[[bytes], bytes] = zstandard.ZstdCompressor(write_checksum=True).compress
    return compress


def merged_metadata(before: dict[str, Any], after: dict[str, Any]) -> dict[str, Any]:
    """What metadata.yaml says about a bag's files together, from what it would say about two parts of it."""
    files = before["files"] + after["files"]
    filled = [file for file in files if file["message_count"]] or files[:1]
    start = min(_start(file) for file in filled)
    end = max(_start(file) + file["duration"]["nanoseconds"] for file in filled)
    topics = [
        {**one, "message_count": one["message_count"] + other["message_count"]}
        for one, other in zip(
            before["topics_with_message_count"], after["topics_with_message_count"], strict=True
        )
    ]
    return {
        **before,
        "relative_file_paths": [file["path"] for file in files],
        "starting_time": {"nanoseconds_since_epoch": start},
        "duration": {"nanoseconds": end - start},
        "message_count": before["message_count"] + after["message_count"],
        "topics_with_message_count": topics,
        "files": files,
    }


def _start(file: dict[str, Any]) -> int:
    return int(file["starting_time"]["nanoseconds_since_epoch"])
