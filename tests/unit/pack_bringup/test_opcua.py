"""What a PLC is told: alarms, values, who is let in, and what the cells' messages count as."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pack_bringup.opcua.alarms import AlarmBoard, AlarmKind
from pack_bringup.opcua.server import ServerSettings
from pack_bringup.opcua.view import CellState, PlcView, state_of
from pack_core.cell_condition import CellCondition
from pack_core.cells import CELLS, cell_part
from pack_core.errors import ConfigError, PackError
from pack_core.paths import config_path, project_root
from pallet_fsm.states import State

T0 = datetime(2026, 11, 29, tzinfo=UTC)
READY = CellCondition(is_up=True)


def test_an_alarm_keeps_the_time_at_which_it_began_and_is_told_once_for_each_change() -> None:
    board = AlarmBoard()
    board.put(AlarmKind.NODE_FAULT, "silent", T0, "motion")
    board.put(AlarmKind.NODE_FAULT, "silent", T0 + timedelta(seconds=1), "motion")
    board.put(AlarmKind.NODE_FAULT, "has ended", T0 + timedelta(seconds=2), "motion")
    board.put(AlarmKind.NODE_FAULT, "silent", T0, "fsm")
    assert [(alarm.in_words, alarm.since) for alarm in board.active] == [
        ("motion: has ended", T0), ("fsm: silent", T0),
    ]  # fmt: skip
    board.put(AlarmKind.NODE_FAULT, "", T0, "motion")
    board.put(AlarmKind.NODE_FAULT, "", T0, "motion")
    told = [(alarm.name, alarm.text, alarm.is_active) for alarm in board.take_changes()]
    assert told == [
        ("NodeFault.motion", "silent", True), ("NodeFault.motion", "has ended", True),
        ("NodeFault.fsm", "silent", True), ("NodeFault.motion", "has ended", False),
    ]  # fmt: skip
    assert board.begun == 2
    assert board.take_changes() == ()


@pytest.mark.parametrize(
    ("change", "state"),
    [
        ({"is_up": False}, CellState.NOT_UP), ({}, CellState.READY),
        ({"waits_for": "sim"}, CellState.WAITING),
        ({"is_starting": True}, CellState.STARTING), ({"is_busy": True}, CellState.BUSY),
        ({"is_busy": True, "is_paused": True}, CellState.PAUSED),
        ({"is_busy": True, "is_stopped": True}, CellState.STOPPED),
    ],
)  # fmt: skip
def test_the_state_is_what_an_operator_has_to_know_first(change: dict[str, Any], state: CellState) -> None:
    assert state_of(replace(READY, **change)) is state


@pytest.mark.parametrize("cell", CELLS)
def test_every_variable_has_a_value(cell: str) -> None:
    view = PlcView(cell, ["sim", "fsm"], cell_part(cell, "production")())
    paths = [variable.path for variable in view.variables()]
    assert sorted(paths) == sorted(view.values())
    assert len(set(paths)) == len(paths)


def test_the_page_names_every_variable() -> None:
    page = (project_root() / "docs" / "operate" / "opcua.md").read_text()
    variables = PlcView("palletizing", [], cell_part("palletizing", "production")()).variables()
    assert [path for path in (variable.path for variable in variables) if f"`{path}`" not in page] == []


@pytest.mark.parametrize("cell", CELLS)
def test_a_text_that_is_no_order_is_refused(cell: str) -> None:
    with pytest.raises(PackError):
        cell_part(cell, "given_goal")("[1, 2", 0)


def test_a_given_order_is_sent_as_it_came() -> None:
    text = config_path("orders", "order_03.json").read_text()
    goal = cell_part("palletizing", "given_goal")(text, 3)
    assert (goal.text, goal.seed) == (text, 3)


def state(entered: State, box: str, reason: str = "", place: str = "pallet") -> SimpleNamespace:
    return SimpleNamespace(state=entered.label, box=box, reason=reason, place=place)


def test_boxes_count_once_they_stand_on_a_pallet_and_not_when_they_are_put_back_or_set_aside() -> None:
    work = cell_part("palletizing", "production")()
    states, result, places = work.topics
    for entered in (State.PUT_BACK, State.RETREAT, State.DEPOSIT, State.RETREAT):
        work.take(states, state(entered, "a"))
    for entered in (State.DEPOSIT, State.RETREAT):
        work.take(states, state(entered, "b", place="reorientation_table"))
    assert work.placed == 1
    work.take(states, state(State.GRIP_FAILED, "b", "nothing sticks"))
    assert (work.step, work.item, work.fault) == (State.GRIP_FAILED.label, "b", "nothing sticks")
    work.take(result, SimpleNamespace(data=json.dumps({"is_complete": True, "reason": ""})))
    for away in (["pallet"], ["pallet"], [], ["second_pallet"]):
        work.take(places, SimpleNamespace(away=away))
    assert work.pallets == 3


def test_objects_of_a_list_count_while_the_job_goes_on() -> None:
    work = cell_part("packing", "production")()
    _, result, progress, end = work.topics

    def report(packed: list[bool], start: float = 1.0, exit_reason: str = "done") -> SimpleNamespace:
        rows = [{"packed": is_packed} for is_packed in packed]
        plain = {"start": start, "objects": rows, "stage": "PACK", "object": None, "message": "stuck"}
        return SimpleNamespace(data=json.dumps({**plain, "exit_reason": exit_reason}))

    for packed in ([], [True], [True, False], [True, False, True]):
        work.take(progress, report(packed))
    work.take(end, report([True, False, True]))
    assert (work.placed, work.pallets, work.message) == (2, 0, "stuck")
    work.take(end, report([True], start=9.0))
    assert (work.placed, work.pallets) == (3, 1)
    for no_end in (report([True], start=9.0, exit_reason="canceled"), report([], start=11.0)):
        work.take(end, no_end)
    assert work.pallets == 1
    work.take(result, SimpleNamespace(data=json.dumps({"success": True, "message": ""})))
    assert work.placed == 4


def test_blocks_of_one_goal_after_the_other_add_up() -> None:
    work = cell_part("blocks", "production")()
    status, _ = work.topics
    for picks, pushes in ((0, 0), (1, 0), (1, 1), (0, 0), (1, 0)):
        work.take(status, SimpleNamespace(phase="PICK", block="b", picks=picks, pushes=pushes))
    assert work.placed == 3


def test_other_machines_are_let_in_only_with_certificates_and_who_is_trusted(tmp_path: Path) -> None:
    for name in ("server.pem", "server.key", "trusted.pem"):
        (tmp_path / name).touch()
    certificate, key = tmp_path / "server.pem", tmp_path / "server.key"
    ServerSettings("127.0.0.1", 4840).check()
    ServerSettings("0.0.0.0", 4840, certificate, key, tmp_path).check()
    for settings, words in (
        (ServerSettings("0.0.0.0", 4840), "everybody operate"),
        (ServerSettings("0.0.0.0", 4840, certificate, key), "--trusted"),
        (ServerSettings("127.0.0.1", 4840, certificate), "go together"),
        (ServerSettings("127.0.0.1", 4840, trusted=tmp_path), "--trusted needs"),
        (ServerSettings("127.0.0.1", 4840, certificate, tmp_path / "none"), "no file"),
        (ServerSettings("127.0.0.1", 4840, certificate, key, tmp_path / "none"), "no folder"),
    ):
        with pytest.raises(ConfigError, match=words):
            settings.check()
