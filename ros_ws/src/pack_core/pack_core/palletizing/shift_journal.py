"""The journal of a shift: everything that happened, as events in an SQLite file that only grows.

Every event is on the disk before the shift goes on, so that a process that is killed, or a power cut, loses
nothing: the write-ahead log is synchronized with each transaction. Nothing in it can be changed or deleted.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from pack_core.errors import ConfigError

TABLES = """
CREATE TABLE IF NOT EXISTS facts (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS events (
    number INTEGER PRIMARY KEY AUTOINCREMENT, time REAL NOT NULL, kind TEXT NOT NULL, box TEXT NOT NULL,
    place TEXT NOT NULL, reason TEXT NOT NULL, data TEXT NOT NULL);
CREATE TRIGGER IF NOT EXISTS events_stay BEFORE UPDATE ON events
    BEGIN SELECT RAISE(ABORT, 'a journal only grows'); END;
CREATE TRIGGER IF NOT EXISTS events_last BEFORE DELETE ON events
    BEGIN SELECT RAISE(ABORT, 'a journal only grows'); END;
"""
"""What the file has: facts about the shift as JSON by name, and the events, `data` as JSON."""


class EventKind(StrEnum):
    """What can happen in a shift."""

    BEGAN = "began"
    CAME = "came"
    DECIDED = "decided"
    STATE = "state"
    PUT_DOWN = "put down"
    MOVED = "moved"
    SKIPPED = "skipped"
    LOST = "lost"
    TAKEN = "taken"
    TOUCHED = "touched"
    FELL = "fell"
    ENDED = "ended"


SETTLED = (EventKind.PUT_DOWN, EventKind.SKIPPED, EventKind.LOST)
"""Events with which a box has been dealt with, and does not come again."""
WATCHED = "watched"
"""Name of the fact that a simulator told the journal of unwanted contacts and of boxes on the floor, which a
real cell has no means to see."""


@dataclass(frozen=True)
class ShiftEvent:
    """Something that happened.

    Attributes:
        time: when [s].
        kind: what it was.
        box: what the box is tracked by that it happened to; empty where it did to none.
        place: name of the pallet or table that it is about; empty where it is about none.
        reason: why, in words; empty where nothing is to be said.
        data: all else, as plain values.
    """

    time: float
    kind: EventKind
    box: str = ""
    place: str = ""
    reason: str = ""
    data: dict[str, Any] = field(default_factory=dict)


class ShiftJournal:
    """Writes a journal, from one thread at a time; a context manager.

    Args:
        path: the file; one that is there already is gone on with.
        facts: what the journal says about the shift, as plain values by name; not written anew.

    Raises:
        ConfigError: the file cannot be written, or is no journal.
    """

    def __init__(self, path: Path, facts: Mapping[str, Any]) -> None:
        try:
            self._file = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
            self._file.execute("PRAGMA journal_mode = WAL")
            self._file.execute("PRAGMA synchronous = FULL")
            self._file.executescript(TABLES)
            rows = [(name, json.dumps(value)) for name, value in facts.items()]
            self._file.execute("BEGIN")  # all facts or none, whenever the process is killed
            self._file.executemany("INSERT OR IGNORE INTO facts VALUES (?, ?)", rows)
            self._file.execute("COMMIT")
        except sqlite3.Error as error:
            raise ConfigError(f"{path} cannot be written as a journal: {error}") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def write(self, events: Iterable[ShiftEvent]) -> None:
        """Add events; they are on the disk when this returns."""
        rows = [(e.time, e.kind, e.box, e.place, e.reason, json.dumps(e.data)) for e in events]
        if not rows:
            return
        self._file.execute("BEGIN")
        self._file.executemany(
            "INSERT INTO events (time, kind, box, place, reason, data) VALUES (?, ?, ?, ?, ?, ?)", rows
        )
        self._file.execute("COMMIT")


@dataclass(frozen=True)
class WrittenShift:
    """What a journal has.

    Attributes:
        facts: about the shift, by name.
        events: in the sequence in which they were written.
    """

    facts: dict[str, Any]
    events: tuple[ShiftEvent, ...]


def read_journal(path: Path) -> WrittenShift:
    """Read a journal, also one whose writer was killed or writes on.

    Raises:
        ConfigError: there is no such file, or it is no journal.
    """
    if not path.is_file():
        raise ConfigError(f"{path}: there is no such file; a shift's folder has its journal, {JOURNAL}")
    try:
        with closing(sqlite3.connect(path)) as file:
            facts = {name: json.loads(value) for name, value in file.execute("SELECT * FROM facts")}
            rows = file.execute(
                "SELECT time, kind, box, place, reason, data FROM events ORDER BY number"
            ).fetchall()
        events = [
            ShiftEvent(time, EventKind(kind), box, place, reason, json.loads(data))
            for time, kind, box, place, reason, data in rows
        ]
    except (sqlite3.Error, ValueError) as error:
        raise ConfigError(f"{path} is no journal of a shift: {error}") from error
    return WrittenShift(facts, tuple(events))


FACTS = ("seed", "boxes", "preset")
"""What a journal has to say of its shift before that can be gone on with."""


def read_interrupted(path: Path, preset: str | None = None) -> WrittenShift:
    """Read the journal of a shift that is to be gone on with.

    Args:
        path: the file.
        preset: of the cell in which it is gone on with; None where that is not known here.

    Raises:
        ConfigError: it cannot be read, its shift was never begun, or it is of another cell.
    """
    written = read_journal(path)
    if missing := [name for name in FACTS if name not in written.facts]:
        raise ConfigError(
            f"{path} does not say {', '.join(missing)}: its shift never began; begin another one, in another "
            "folder"
        )
    if preset is not None and written.facts["preset"] != preset:
        raise ConfigError(
            f"{path} is of the preset '{written.facts['preset']}', this cell is under '{preset}'; go on with "
            "it in a cell under its preset"
        )
    return written


JOURNAL = "journal.db"
"""Name of the journal in a shift's folder."""
