"""Writes a run to an MCAP bag from one thread of its own; a kill loses at most one flush period."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Lock, Thread

from rosbags.rosbag2.errors import WriterError
from rosbags.typesys.store import Typestore

from pack_bringup.recording.bag_writer import BagWriter
from pack_core.bag_topic import Topic
from pack_core.errors import BagError

FLUSH_PERIOD = 0.2
"""Wall clock [s] between two moments at which all that was received is in the file. With what else a message
waits for, a kill then loses less than half a second; shorter chunks would make the file larger."""
QUEUE_SIZE = 100_000
"""Messages that may wait for a slow disk before new ones are dropped and counted."""
Stamped = tuple[str, int, bytes]
"""A message: its topic, simulated time [ns], and CDR form."""
STORAGE_ERRORS = (OSError, WriterError)


class Recorder:
    """An open bag (rosbag2 format 9, MCAP) that takes serialised messages and never blocks.

    Once the disk is full or fails, or the bag has reached its limit, `fault` says so and all further
    messages are dropped; what was flushed before stays readable.

    Args:
        path: the bag's folder, which is made.
        topics: what will be written.
        types: definitions of their messages.
        split_size: size of a file at which the next one is begun [byte].
        limit: size of all files at which recording ends [byte].

    Raises:
        BagError: the folder exists already or cannot be written.
    """

    def __init__(
        self,
        path: Path,
        topics: Iterable[Topic],
        types: Typestore,
        *,
        split_size: float = float("inf"),
        limit: float = float("inf"),
    ) -> None:
        self.path, self._limit = path, limit
        self.fault = ""
        self.dropped = 0
        self.written: Counter[str] = Counter()
        self._waiting, self._counting = 0, Lock()
        # Many messages at a time: handing over one by one would wake the writer's thread for each.
        self._queue: SimpleQueue[list[Stamped] | None] = SimpleQueue()
        self._writer = _open(path, topics, types, split_size)
        self._thread = Thread(target=self._run, name="bag writer", daemon=True)
        self._thread.start()

    def write(self, topic: str, time_ns: int, data: bytes) -> None:
        """Hand over a message, stamped with simulated time; `data` is its CDR form."""
        self.write_all([(topic, time_ns, data)])

    def write_all(self, messages: list[Stamped]) -> None:
        """Hand over messages in the order in which they are to stand in the bag."""
        if self.fault or self._waiting + len(messages) > QUEUE_SIZE:
            self.dropped += len(messages)
            return
        with self._counting:
            self._waiting += len(messages)
        self._queue.put(messages)

    def close(self) -> None:
        """Write what is waiting, then the index and metadata.yaml."""
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join()

    def _run(self) -> None:
        is_ended = False
        try:
            is_ended = self._consume()
            size = self._writer.size
            self._writer.close()
            if not is_ended:
                self.fault = (
                    f"recording to {self.path} stopped: {size / 1e9:.3g} GB, and the limit is "
                    f"{self._limit / 1e9:.3g} GB (limit_gb); the bag is whole, goals go on unrecorded"
                )
        except STORAGE_ERRORS as error:
            self._give_up(str(error))
        except Exception as error:  # of a message that cannot be written; nobody else would tell of it
            self._give_up(repr(error))
        if not is_ended:
            self._discard()

    def _give_up(self, reason: str) -> None:
        self.fault = f"recording to {self.path} stopped: {reason}; what was written before is readable"
        with suppress(*STORAGE_ERRORS):
            self._writer.abort()

    def _consume(self) -> bool:
        """Write until `close` is called (True) or the limit is reached (False)."""
        next_flush = time.monotonic() + FLUSH_PERIOD
        while True:
            if (wait := next_flush - time.monotonic()) <= 0.0:
                self._writer.flush()
                if not self._writer.is_there:
                    raise WriterError("its folder was removed or renamed")
                if self._writer.size >= self._limit:
                    return False
                next_flush = time.monotonic() + FLUSH_PERIOD
                continue
            with suppress(Empty):
                messages = self._queue.get(timeout=wait)
                if messages is None:
                    return True
                for topic, time_ns, data in messages:
                    self._writer.write(topic, time_ns, data)
                    self.written[topic] += 1
                with self._counting:
                    self._waiting -= len(messages)

    def _discard(self) -> None:
        """Take messages until the end without keeping them, so that nobody waits for room."""
        while (messages := self._queue.get()) is not None:
            self.dropped += len(messages)


def _open(path: Path, topics: Iterable[Topic], types: Typestore, split_size: float) -> BagWriter:
    try:
        return BagWriter(path, topics, types, split_size)
    except STORAGE_ERRORS as error:
        raise BagError(f"cannot record to {path}: {error}; give another `path`") from error
