"""The journal of a shift only grows, and loses nothing when its writer is killed."""

import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.shift_journal import (
    EventKind,
    ShiftEvent,
    ShiftJournal,
    read_interrupted,
    read_journal,
)

WRITER = """
import sys
from pathlib import Path
from pack_core.palletizing.shift_journal import EventKind, ShiftEvent, ShiftJournal
with ShiftJournal(Path(sys.argv[1]), {"seed": 3}) as journal:
    for number in range(10**9):
        journal.write([ShiftEvent(number, EventKind.CAME, f"b{number}", data={"size": [0.4, 0.3, 0.2]})])
        print(number, flush=True)
"""


def event(number: int) -> ShiftEvent:
    return ShiftEvent(float(number), EventKind.PUT_DOWN, f"b{number}", "pallet", "", {"weight": 0.1 * number})


def test_what_was_written_is_read_and_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "journal.db"
    with ShiftJournal(path, {"seed": 7, "boxes": 20}) as journal:
        journal.write([event(1), event(2)])
    with ShiftJournal(path, {"seed": 8}) as journal:  # what was said first stays
        journal.write([event(3)])
    written = read_journal(path)
    assert written.facts == {"seed": 7, "boxes": 20}
    assert written.events == (event(1), event(2), event(3))


def test_nothing_is_lost_when_the_writer_is_killed(tmp_path: Path) -> None:
    path = tmp_path / "journal.db"
    writer = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True)
    told = [writer.stdout.readline() for _ in range(20)]
    writer.kill()  # as kill -9 does
    told += writer.stdout.readlines()
    writer.wait()
    events = read_journal(path).events
    last = int(told[-1])
    assert [event.time for event in events] == list(range(len(events)))
    assert last + 1 <= len(events) <= last + 2  # the last one may be on the disk and not told yet


@pytest.mark.parametrize("change", ["DELETE FROM events", "UPDATE events SET box = 'other'"])
def test_a_journal_cannot_be_changed(tmp_path: Path, change: str) -> None:
    path = tmp_path / "journal.db"
    with ShiftJournal(path, {}) as journal:
        journal.write([event(1)])
    with sqlite3.connect(path) as file, pytest.raises(sqlite3.IntegrityError, match="only grows"):
        file.execute(change)
    assert read_journal(path).events == (event(1),)


def test_a_shift_that_never_began_or_of_another_cell_is_not_gone_on_with(tmp_path: Path) -> None:
    with ShiftJournal(tmp_path / "none.db", {}):
        pass
    with pytest.raises(ConfigError, match="does not say seed, boxes, preset: its shift never began"):
        read_interrupted(tmp_path / "none.db")
    path, facts = tmp_path / "journal.db", {"seed": 1, "boxes": 2, "preset": "shift"}
    with ShiftJournal(path, facts):
        pass
    assert read_interrupted(path, "shift").facts == read_interrupted(path).facts == facts
    with pytest.raises(ConfigError, match="is of the preset 'shift', this cell is under 'mine'"):
        read_interrupted(path, "mine")


def test_what_is_no_journal_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="there is no such file"):
        read_journal(tmp_path / "none.db")
    other = tmp_path / "other.db"
    other.write_text("not a data base, by far, and longer than a header of one")
    with pytest.raises(ConfigError, match="is no journal of a shift"):
        read_journal(other)
    with pytest.raises(ConfigError, match="cannot be written as a journal"):
        ShiftJournal(other, {})
