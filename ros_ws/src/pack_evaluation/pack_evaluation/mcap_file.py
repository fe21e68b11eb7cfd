"""Reads the records of an MCAP file whatever has happened to it, and counts what cannot be read.

No length field is believed further than the file reaches, and a chunk is unpacked up to a limit only. What
is damaged is left out; reading goes on behind it: at the next record, or, where a record's own length is
damaged, at the next chunk that the index at the file's end names. Format: https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Message, Schema
from mcap.writer import MCAP0_MAGIC

HEAD = struct.Struct("<BQ")
"""In front of a record's content: its kind, and the length of its content."""
FOOTER_SIZE = HEAD.size + 20 + len(MCAP0_MAGIC)
"""Footer and magic at the very end of a finished file."""
LARGEST_CHUNK = 128 * 2**20
"""A chunk that claims to unpack to more is damaged; writers close a chunk after some megabytes [byte]."""
FIRST_OF_OTHERS = 0x10
"""Kinds of records from here on are those of later versions, from 0x80 on private ones: they are skipped."""
KINDS = frozenset(Opcode)
DAMAGE = (McapError, struct.error, ValueError, EOFError, RuntimeError, zstandard.ZstdError, MemoryError)
"""What the parsers and decompressors raise where the bytes are damaged."""


@dataclass
class McapContent:
    """What could be read of a file.

    Attributes:
        schemas: by their number; also those that only the index at the end still has.
        channels: by their number, likewise.
        messages: in the order of the file.
        is_whole: whether the file ends as a finished one does.
        damaged: number of chunks and other records that could not be read.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    messages: list[Message] = field(default_factory=list)
    is_whole: bool = False
    damaged: int = 0


def read_mcap(data: bytes) -> McapContent:
    """All that is readable in the bytes of an MCAP file; nothing where they are something else."""
    content = McapContent()
    if not data.startswith(MCAP0_MAGIC):
        return content
    content.is_whole = data.endswith(MCAP0_MAGIC) and len(data) > FOOTER_SIZE
    position = len(MCAP0_MAGIC)
    while True:
        for kind, start, end in _records(data, position, len(data)):
            position = end
            if kind == Opcode.FOOTER:
                return content
            _take(kind, data[start:end], content)
        if position >= len(data) or not content.is_whole:
            return content  # cut off here, as by a recorder that was killed
        content.damaged += 1
        following = [start for start in _chunk_starts(data) if start > position]
        position = min(following, default=_summary_start(data))
        if not following:
            for kind, start, end in _records(data, position, len(data)):
                _take(kind, data[start:end], content)
            return content


def _records(data: bytes, position: int, limit: int) -> Iterator[tuple[int, int, int]]:
    """Kind, start and end of the content of every record, up to the first that is none or goes too far."""
    while position + HEAD.size <= limit:
        kind, length = HEAD.unpack_from(data, position)
        start = position + HEAD.size
        if not (kind in KINDS or kind >= FIRST_OF_OTHERS) or length > limit - start:
            return
        position = start + length
        yield kind, start, position


def _take(kind: int, record: bytes, content: McapContent) -> None:
    """Add a record of the file to the content, or count it as damaged."""
    try:
        if kind == Opcode.CHUNK:
            for inner_kind, inner in _unpacked(record):
                _add(inner_kind, inner, content)
        else:
            _add(kind, record, content)
    except DAMAGE:
        content.damaged += 1


def _add(kind: int, record: bytes, content: McapContent) -> None:
    # The first of a number stays: the index at the end repeats schemas and channels.
    if kind == Opcode.SCHEMA:
        schema = Schema.read(_stream(record))
        content.schemas.setdefault(schema.id, schema)
    elif kind == Opcode.CHANNEL:
        channel = Channel.read(_stream(record))
        content.channels.setdefault(channel.id, channel)
    elif kind == Opcode.MESSAGE:
        content.messages.append(Message.read(_stream(record), len(record)))


def _unpacked(record: bytes) -> list[tuple[int, bytes]]:
    """Kinds and contents of all records of a chunk.

    Raises:
        ValueError: the chunk is not whole; the decompressors raise other errors of `DAMAGE`.
    """
    chunk = Chunk.read(_stream(record))
    if chunk.uncompressed_size > LARGEST_CHUNK:
        raise ValueError(f"a chunk of {chunk.uncompressed_size} bytes")
    data = _decompressed(chunk)
    if len(data) != chunk.uncompressed_size:
        raise ValueError(f"a chunk of {len(data)} bytes, not {chunk.uncompressed_size}")
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise ValueError("a chunk with a wrong checksum")
    found = list(_records(data, 0, len(data)))
    if (found[-1][2] if found else 0) != len(data):
        raise ValueError("a chunk with a record that is not whole")
    return [(kind, data[start:end]) for kind, start, end in found]


def _decompressed(chunk: Chunk) -> bytes:
    """A chunk's records, at most one byte more than it claims, so that a false claim is noticed."""
    most = chunk.uncompressed_size + 1
    if chunk.compression == "zstd":
        # As a stream: the whole would be unpacked into as much memory as the frame's own header asks for.
        with zstandard.ZstdDecompressor(max_window_size=2**27).stream_reader(BytesIO(chunk.data)) as stream:
            return bytes(stream.read(most))
    if chunk.compression == "lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most))
    if chunk.compression == "":
        return bytes(chunk.data)
    raise ValueError(f"compression '{chunk.compression}'")


def _summary_start(data: bytes) -> int:
    """Where the index at the end begins: the footer says so; the file's end if it cannot be so."""
    start = int.from_bytes(data[len(data) - FOOTER_SIZE + HEAD.size :][:8], "little")
    return start if 0 < start < len(data) else len(data)


def _chunk_starts(data: bytes) -> list[int]:
    """Where chunks begin, as the index at the end has it."""
    starts = []
    for kind, start, end in _records(data, _summary_start(data), len(data)):
        if kind == Opcode.CHUNK_INDEX:
            try:
                starts.append(ChunkIndex.read(_stream(data[start:end])).chunk_start_offset)
            except DAMAGE:
                continue
    return [start for start in starts if start < len(data)]


def _stream(record: bytes) -> Any:
    return ReadDataStream(BytesIO(record))
