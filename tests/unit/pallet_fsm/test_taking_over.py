"""Half built pallets are taken over by the journal and by a scan."""

from pathlib import Path

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PALLET, REORIENTATION_TABLE
from pack_core.palletizing.shift_journal import EventKind, ShiftJournal, read_journal
from pack_core.rotations import Pose, from_yaw, multiply
from pallet_fsm.palletizer_config import ScanConfig
from pallet_fsm.taking_over import TakenOver, rejected_by_journal, standing_by_journal, take_over
from unit.pallet_fsm.fake_shift import CELL, Came, FakeShiftCell, ShiftRunning, go_on, listed, run_shift
from unit.pallet_fsm.test_shift_job import LARGE, LOW

TEA = listed("tea")


@pytest.fixture
def interrupted(tmp_path: Path) -> tuple[ShiftRunning, Path]:
    """Three boxes on pallets, and the journal of it."""
    shift = run_shift([Came("tea")] * 3, [TEA])
    with ShiftJournal(tmp_path / "journal.db", {}) as journal:
        journal.write(shift.events)
    return shift, tmp_path / "journal.db"


def seen(cell: FakeShiftCell, journal: Path) -> TakenOver:
    """What is taken over of a cell as it stands now."""
    places = (*CELL.pallets, REORIENTATION_TABLE)
    for place in places:
        cell._scan(place)
    standing = standing_by_journal(read_journal(journal).events)
    return take_over(standing, {place: cell.scans[place] for place in places}, CELL, ScanConfig())


def test_what_stands_as_the_journal_says_is_gone_on_with(interrupted) -> None:
    shift, journal = interrupted
    found = seen(shift.cell, journal)
    assert (found.doubts, found.closed) == ((), frozenset())
    assert {work.name for work, _ in found.standing} == {"b1", "b2", "b3"}
    shift.cell.stream = [Came("tea")] * 2
    after = go_on(shift.cell, 2, found, scans=ScanConfig())
    assert after.job.reason == "all boxes came"
    assert len(shift.cell.boxes) == 5
    for one in shift.cell.boxes.values():
        others = [other for other in shift.cell.boxes.values() if other is not one]
        assert min(np.linalg.norm(one.p - other.p) for other in others) > 0.15


def test_a_box_moved_by_hand_is_known_to_stand_elsewhere(interrupted) -> None:
    shift, journal = interrupted
    X_WB = shift.cell.boxes["b1"]
    moved = Pose(X_WB.p + np.array([0.012, -0.009, 0.0]), multiply(from_yaw(np.deg2rad(1.0)), X_WB.q))
    shift.cell.boxes["b1"] = moved
    found = seen(shift.cell, journal)
    (doubt,) = found.doubts
    assert doubt.startswith("pallet: box b1 stands 1")
    assert found.closed == frozenset()
    work = next(work for work, _ in found.standing if work.name == "b1")
    assert np.linalg.norm(work.X_WB.p - moved.p) < 0.002


def test_a_pallet_from_which_a_box_is_gone_is_taken_away(interrupted) -> None:
    shift, journal = interrupted
    where = {event.box: event.place for event in shift.of(EventKind.PUT_DOWN)}
    name = next(box for box, place in where.items() if place == PALLET)
    del shift.cell.boxes[name]
    found = seen(shift.cell, journal)
    assert found.closed == {PALLET}
    assert found.doubts == (f"pallet: box {name} is gone",)


def test_a_pallet_with_something_foreign_on_it_is_taken_away(interrupted) -> None:
    shift, journal = interrupted
    deck = CELL.deck(PALLET).X_WD
    shift.cell.strangers.append(Obstacle("a", Pose(deck.apply([1.0, 0.6, 0.1])), np.array([0.2, 0.2, 0.2])))
    assert seen(shift.cell, journal).closed == {PALLET}


@pytest.fixture
def two_set_aside(tmp_path: Path) -> tuple[ShiftRunning, Path]:
    """Eight boxes on pallets, one of which was taken away, two on table B, and the journal of it."""
    shift = run_shift([Came("large")] * 10, [LARGE], LOW)
    with ShiftJournal(tmp_path / "journal.db", {}) as journal:
        journal.write(shift.events)
    return shift, tmp_path / "journal.db"


def on_table_b(shift: ShiftRunning) -> str:
    return next(e.box for e in shift.of(EventKind.PUT_DOWN) if e.place == REORIENTATION_TABLE)


def test_a_box_that_is_gone_from_table_b_is_lost_and_its_place_is_free(two_set_aside) -> None:
    shift, journal = two_set_aside
    name = on_table_b(shift)
    del shift.cell.boxes[name]
    found = seen(shift.cell, journal)
    assert [(work.name, reason) for work, reason in found.lost] == [
        (name, f"seen on table B: box {name} is gone")
    ]
    assert name not in {work.name for work, _ in found.standing}
    shift.cell.stream = [Came("large")]
    after = go_on(shift.cell, 1, found)
    assert [event.box for event in after.of(EventKind.LOST)] == [name]


def test_a_box_that_was_moved_far_on_table_b_must_be_taken_off_first(two_set_aside) -> None:
    shift, journal = two_set_aside
    name = on_table_b(shift)
    X_WB = shift.cell.boxes[name]
    shift.cell.boxes[name] = Pose(X_WB.p + np.array([0.0, 0.05, 0.0]), X_WB.q)
    with pytest.raises(ConfigError, match=f"table B: box {name} stands 50 mm .*; take it off, then go on"):
        seen(shift.cell, journal)


def test_something_foreign_on_table_b_must_be_taken_off_first(interrupted) -> None:
    shift, journal = interrupted
    table = CELL.reorientation_table
    p = np.array([*table.centre, table.height + 0.1])
    shift.cell.strangers.append(Obstacle("a", Pose(p), np.array([0.2, 0.2, 0.2])))
    with pytest.raises(ConfigError, match=r"table B: something of .*; take it off, then go on"):
        seen(shift.cell, journal)


def test_a_box_that_was_moved_is_planned_around_where_it_stands(interrupted) -> None:
    shift, journal = interrupted
    X_WB = shift.cell.boxes["b1"]
    shift.cell.boxes["b1"] = Pose(X_WB.p + np.array([0.02, 0.0, 0.0]), X_WB.q)
    work = next(work for work, _ in seen(shift.cell, journal).standing if work.name == "b1")
    p_WB = CELL.deck(work.deck).X_WD.apply(work.plan.placed.centre)
    assert np.linalg.norm(p_WB - shift.cell.boxes["b1"].p) < 0.004


def test_a_reject_that_nobody_was_told_to_take_away_is_known_by_the_journal() -> None:
    shift = run_shift([Came("", (0.4, 0.3, 0.2)), Came("tea")], [TEA])
    assert rejected_by_journal(shift.events) == ()
    down = next(i for i, event in enumerate(shift.events) if event.kind is EventKind.PUT_DOWN)
    assert rejected_by_journal(shift.events[: down + 1]) == ("b1",)
    assert standing_by_journal(shift.events[: down + 1]) == []
    after = go_on(shift.cell, 0, TakenOver(rejected=("b1",)))
    assert rejected_by_journal([*shift.events[: down + 1], *after.events]) == ()


def test_boxes_that_were_set_aside_go_to_the_new_pallet(tmp_path: Path) -> None:
    before = run_shift([Came("large")] * 10, [LARGE], LOW)
    path = tmp_path / "journal.db"
    with ShiftJournal(path, {}) as journal:
        journal.write(before.events)
    cell = before.cell
    found = seen(cell, path)
    assert (found.doubts, found.closed) == ((), frozenset())
    cell.stream = [Came("large")]
    after = go_on(cell, 1, found)
    assert [event.box for event in after.of(EventKind.PUT_DOWN)] == ["b9", "b10", "b11"]


def test_what_was_taken_away_does_not_stand() -> None:
    shift = run_shift([Came("large")] * 12, [LARGE], LOW)
    standing = {work.name for work, _ in standing_by_journal(shift.events)}
    assert standing == set(shift.cell.boxes)
