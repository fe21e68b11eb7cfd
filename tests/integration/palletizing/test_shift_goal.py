"""A goal of `/run_shift` in a cell without physics: its journal, its feedback, and going on after a kill."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from pack_interfaces.action import RunShift

from pack_bringup.palletizing.goals import ShiftGoal
from pack_core.palletizing.ports import AskPlace, Command, PursueTarget, ScanPlace, StopArm
from pack_core.palletizing.shift_journal import (
    JOURNAL,
    EventKind,
    ShiftJournal,
    WrittenShift,
    read_journal,
)
from pack_core.ros.contracts import palletizing as contracts
from pack_core.rotations import Pose
from pallet_fsm.palletizer_config import PalletizerConfig, ScanConfig
from pallet_fsm.ros.shift_goal import ShiftGoalRun, TakeOverLook, requested_shift
from pallet_fsm.shift_job import ShiftConfig, ShiftJob
from pallet_fsm.taking_over import TakenOver, standing_by_journal
from unit.pallet_fsm.fake_shift import CELL, Came, FakeShiftCell, listed
from unit.pallet_fsm.faults import Faults

TEA = listed("tea")
MACHINE = PalletizerConfig(scans=ScanConfig(period=0.0))


@dataclass
class Server:
    """Takes what a goal tells its node."""

    is_cancel_requested: bool = False
    has_ended: bool = False
    feedback: list[Any] = field(default_factory=list)
    states: list[Any] = field(default_factory=list)

    def publish_feedback(self, feedback: Any) -> None:
        self.feedback.append(feedback)

    def end_goal(self) -> None:
        self.has_ended = True

    def publish(self, state: Any) -> None:
        self.states.append(state)


def cell_of(count: int) -> FakeShiftCell:
    return FakeShiftCell(None, Faults(), stream=[Came("tea")] * count, catalogue={"tea": TEA})


def pursue(
    cell: FakeShiftCell, goal: RunShift.Goal, *, killed_after: int | None = None
) -> tuple[RunShift.Result, Server]:
    """Run a goal to its end, or until so many boxes have been put down."""
    server, before = Server(), requested_shift(goal, "shift")

    def begin(found: TakenOver, boxes: int) -> ShiftJob:
        return ShiftJob(CELL, cell.catalogue, ShiftConfig(patience=20.0), MACHINE, boxes, found)

    look = TakeOverLook(CELL, standing_by_journal(before.events), MACHINE, ShiftConfig().clearances(CELL))
    with ShiftJournal(Path(goal.folder) / JOURNAL, before.facts) as journal:
        run = ShiftGoalRun(server, CELL, before, journal, begin, cell.apply, server, look)  # type: ignore[arg-type]
        while not server.has_ended and run.result().placed != killed_after:
            run.step(cell.observe())
    return run.result(), server


def test_a_shift_is_run_told_and_written(tmp_path: Path) -> None:
    result, server = pursue(cell_of(2), RunShift.Goal(folder=str(tmp_path), boxes=2, seed=7))
    assert (result.success, result.message) == (True, "all boxes came")
    assert (result.came, result.placed, result.boxes) == (2, 2, 2)
    written = read_journal(tmp_path / JOURNAL)
    assert written.facts == {"seed": 7, "boxes": 2, "preset": "shift"}
    visits = [event for event in written.events if event.kind is EventKind.STATE]
    assert [state.state for state in server.states] == [visit.data["state"] for visit in visits]
    assert server.feedback[-1].placed == 2


def test_a_shift_goes_on_where_it_was_killed_though_the_clock_begins_anew(tmp_path: Path) -> None:
    first = cell_of(3)
    pursue(first, RunShift.Goal(folder=str(tmp_path), boxes=3), killed_after=1)
    contract, request = ShiftGoal(tmp_path, is_resumed=True).reset()
    assert contract is contracts.RESET
    assert request.come == [box.name for box in request.standing] == ["b1"]
    again = cell_of(2)
    put_down = next(e for e in read_journal(tmp_path / JOURNAL).events if e.kind is EventKind.PUT_DOWN)
    pose = np.array(put_down.data["pose"])
    again.boxes["first"], again.sizes["first"] = Pose(pose[:3], pose[3:]), (0.4, 0.3, 0.2)
    again._infeed = first._infeed
    result, _ = pursue(again, RunShift.Goal(folder=str(tmp_path), resume=True))
    assert (result.success, result.came, result.placed) == (True, 3, 3)
    events = read_journal(tmp_path / JOURNAL).events
    times = [event.time for event in events if event.kind is not EventKind.STATE]
    assert times == sorted(times)
    began = [event for event in events if event.kind is EventKind.BEGAN]
    assert [event.data["standing"] for event in began] == [0, 1]
    assert [event.reason for event in began] == ["", ""]


def left_over_the_pallet(tmp_path: Path, faults: Faults) -> FakeShiftCell:
    """A cell whose arm was left over the pallet, one box standing and one still to come."""
    first = cell_of(2)
    pursue(first, RunShift.Goal(folder=str(tmp_path), boxes=2), killed_after=1)
    cell = FakeShiftCell(None, faults, stream=[Came("tea")], catalogue={"tea": TEA})
    cell.boxes["b1"], cell.sizes["b1"] = first.boxes["b1"], first.sizes["b1"]
    cell._infeed = first._infeed
    cell.X_WT = Pose(cell.boxes["b1"].p + np.array([0.0, 0.0, 0.101]), cell.X_WT.q)
    return cell


def test_an_arm_that_hides_a_place_moves_away_before_it_is_looked_at(tmp_path: Path) -> None:
    result, _ = pursue(
        left_over_the_pallet(tmp_path, Faults()), RunShift.Goal(folder=str(tmp_path), resume=True)
    )
    assert (result.success, result.placed) == (True, 2)
    began = [e for e in read_journal(tmp_path / JOURNAL).events if e.kind is EventKind.BEGAN]
    assert [event.reason for event in began] == ["", ""]


def test_an_arm_that_was_left_over_the_conveyor_moves_away_before_a_box_is_brought(tmp_path: Path) -> None:
    cell = cell_of(1)
    cell.X_WT = Pose(np.array([*CELL.picking_table.centre, 1.6]), cell.X_WT.q)
    result, _ = pursue(cell, RunShift.Goal(folder=str(tmp_path), boxes=1))
    assert (result.success, result.placed) == (True, 1)


@pytest.mark.parametrize("is_cancelled", [False, True])
def test_an_arm_that_moves_away_is_stopped_where_the_goal_ends_meanwhile(is_cancelled: bool) -> None:
    cell, server, commands = cell_of(1), Server(), list[Command]()
    cell.X_WT = Pose(np.array([*CELL.picking_table.centre, 1.6]), cell.X_WT.q)
    before = WrittenShift({"seed": 0, "boxes": 1, "preset": "shift"}, ())
    look = TakeOverLook(CELL, [], MACHINE, ShiftConfig().clearances(CELL))
    run = ShiftGoalRun(server, CELL, before, Mock(), Mock(), commands.append, server, look)  # type: ignore[arg-type]
    run.step(cell.observe())
    assert [type(command) for command in commands] == [PursueTarget]
    server.is_cancel_requested = is_cancelled
    if not is_cancelled:
        run.halt("node 'motion' is silent")
    run.step(cell.observe())
    assert server.has_ended
    assert type(commands[-1]) is StopArm


def test_every_event_is_on_the_disk_before_anything_follows_from_it(tmp_path: Path) -> None:
    cell, kinds = cell_of(1), list[EventKind]()
    apply = cell.apply

    def applying(command: Command) -> None:
        if isinstance(command, AskPlace):
            kinds.extend(event.kind for event in read_journal(tmp_path / JOURNAL).events)
        apply(command)

    cell.apply = applying  # type: ignore[method-assign]
    pursue(cell, RunShift.Goal(folder=str(tmp_path), boxes=1))
    assert kinds == [EventKind.BEGAN, EventKind.CAME]


def test_an_arm_that_hides_a_place_and_finds_no_way_ends_the_goal(tmp_path: Path) -> None:
    cell = left_over_the_pallet(tmp_path, Faults(refused=2))
    result, _ = pursue(cell, RunShift.Goal(folder=str(tmp_path), resume=True))
    assert not result.success
    assert result.message == (
        "the arm is over the pallet or too near; bring it beside, so that nothing there is hidden: "
        "the wrist would hit box 3; the wrist would hit box 3"
    )


def test_a_scanner_that_does_not_answer_ends_the_goal_before_anything_moves(tmp_path: Path) -> None:
    pursue(cell_of(2), RunShift.Goal(folder=str(tmp_path), boxes=2), killed_after=1)
    cell = cell_of(1)
    apply = cell.apply
    cell.apply = lambda command: None if isinstance(command, ScanPlace) else apply(command)  # type: ignore[method-assign]
    result, server = pursue(cell, RunShift.Goal(folder=str(tmp_path), resume=True))
    assert not result.success
    assert result.message == "the scanner over the pallet does not answer"
    assert server.states == []
