"""Pieces of the page: what may be pressed, what is escaped, how an order's progress is told."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from pack_core.cell_condition import CellCondition
from pack_core.palletizing.cell import PALLET
from pack_viewer.event_log import EventLog
from pack_viewer.fragments import RED, chips, facts, headline, lines, signed_list
from pack_viewer.node_board import NodeBoard, level_of
from pack_viewer.palletizing.order_progress import OrderProgress
from pack_viewer.rolling_plot import RollingPlot
from pallet_fsm.states import ENDS, State

READY = CellCondition(is_up=True)
EVIL = '<script>alert("x")</script>&'


@pytest.mark.parametrize(
    "html",
    [
        headline(EVIL, EVIL), lines([EVIL]), facts([(EVIL, EVIL)]), signed_list([("·", "red", EVIL)]),
        chips([EVIL], EVIL, [EVIL], [EVIL]),
    ],
)  # fmt: skip
def test_every_text_from_outside_is_escaped(html: str) -> None:
    assert "<script" not in html
    assert "&lt;script&gt;" in html


def test_texts_of_an_order_are_escaped() -> None:
    progress = OrderProgress()
    progress.enter(EVIL, EVIL, EVIL, EVIL, 0.0)
    progress.enter(State.GRIP_FAILED.label, EVIL, EVIL, EVIL, 1.0)
    progress.enter(State.DEPOSIT.label, EVIL, PALLET, "", 2.0)
    progress.enter(State.RETREAT.label, EVIL, PALLET, "", 2.0)
    progress.enter(State.RETURN.label, EVIL, PALLET, "", 3.0)
    assert "<script" not in progress.states_html() + progress.cycles_html()


def test_a_goal_can_be_started_only_in_a_cell_that_is_ready() -> None:
    assert READY.can_start
    for change in (
        {"is_up": False}, {"waits_for": "a scene"}, {"is_busy": True}, {"is_starting": True},
        {"is_paused": True},
    ):  # fmt: skip
        assert not replace(READY, **change).can_start


def test_only_a_goal_in_progress_can_be_cancelled() -> None:
    assert not READY.can_cancel
    assert replace(READY, is_busy=True).can_cancel


def test_the_arm_can_be_stopped_at_any_time_and_resumed_only_after_that() -> None:
    for condition in (READY, replace(READY, is_busy=True), replace(READY, is_paused=True)):
        assert condition.can_stop
        assert not condition.can_resume
    stopped = replace(READY, is_stopped=True)
    assert not stopped.can_stop
    assert stopped.can_resume


def test_a_cell_that_is_not_up_has_no_button_to_press() -> None:
    nothing = CellCondition()
    assert not any(
        (nothing.can_start, nothing.can_cancel, nothing.can_pause, nothing.can_stop, nothing.can_resume)
    )


def status(name: str, level: bytes | int, message: str) -> SimpleNamespace:
    return SimpleNamespace(status=[SimpleNamespace(name=name, level=level, message=message)])


def test_levels_are_read_from_ros_and_from_recordings() -> None:
    assert level_of(b"\x02") == level_of(2) == 2


def test_a_node_that_falls_silent_is_a_fault() -> None:
    now = [0.0]
    board = NodeBoard(EventLog(), ("mpc", "sim"), clock=lambda: now[0])
    board.take(status("mpc", b"\x00", "ok"))
    assert not board.has_fault
    now[0] = 10.0
    assert board.silent == ["mpc"]
    assert board.has_fault
    assert "silent for 10 s" in board.html()
    board.take(status("mpc", b"\x00", "ok"))
    assert not board.has_fault


def test_whoever_sent_a_goal_may_leave() -> None:
    now = [0.0]
    board = NodeBoard(EventLog(), ("mpc", "sim"), clock=lambda: now[0])
    board.take(status("goal", 0, "ok"))
    assert "goal" in board.html()
    now[0] = 10.0
    assert not board.has_fault
    assert "goal" not in board.html()


def test_in_a_recording_that_is_held_nobody_falls_silent() -> None:
    now = [0.0]
    board = NodeBoard(EventLog(), None, clock=lambda: now[0])
    board.take(status("mpc", 0, "ok"))
    now[0] = 10.0
    assert board.silent == []


def test_an_error_that_a_node_reports_is_a_fault() -> None:
    board = NodeBoard(EventLog(), ("mpc", "sim"))
    board.take(status("sim", 2, "no scene"))
    assert board.has_fault
    assert "no scene" in board.html()


def test_the_log_tells_once_of_what_is_refused_again_and_again() -> None:
    log = EventLog()
    board = NodeBoard(log, ("mpc", "sim"))
    for count, since in ((1, 0.3), (2, 0.35), (370, 18.5)):
        board.take(status("mpc", 1, f"skipped iteration: {count} (seen nothing for {since} s)"), 4.0 + since)
    assert log.text == "4.30 s  mpc: skipped iteration: 1 (seen nothing for 0.3 s)"
    assert "skipped iteration: 370 (seen nothing for 18.5 s)" in board.html()
    board.take(status("mpc", 1, "skipped iteration: 370 (seen nothing for 18.5 s); late plan: 1"), 30.0)
    assert log.text.splitlines()[0].startswith("30.00 s  mpc: skipped iteration: 370")
    assert len(log.text.splitlines()) == 2


def test_an_error_of_several_lines_is_shown_in_several() -> None:
    shown = signed_list([("✕", RED, "upload refused: line 2: 'a'\nline 3: <b>")])
    assert "white-space:pre-line" in shown
    assert "line 2: &#x27;a&#x27;\nline 3: &lt;b&gt;" in shown


def test_a_warning_leaves_the_board_when_nothing_was_refused_for_a_while_and_an_error_stays() -> None:
    now = [0.0]
    board = NodeBoard(EventLog(), None, clock=lambda: now[0])
    for now[0] in (0.0, 20.0, 29.0):
        board.take(status("mpc", 1, "skipped iteration: 370 (seen nothing)"))
        board.take(status("sim", 2, "no scene"))
        assert "mpc: skipped" in board.html()
    now[0] = 31.0
    assert "skipped" not in board.html()
    assert "mpc" in board.html()
    assert "no scene" in board.html()
    board.take(status("mpc", 1, "skipped iteration: 371 (seen nothing)"))
    assert "mpc: skipped iteration: 371" in board.html()


def enter(progress: OrderProgress, box: str, *visits: tuple[State, float], place: str = PALLET) -> None:
    for state, time in visits:
        progress.enter(state.label, box, place, "", time)


def test_a_boxs_time_runs_from_its_first_state_to_that_of_the_next_box() -> None:
    progress = OrderProgress()
    enter(progress, "a", (State.SPAWN, 1.0), (State.DEPOSIT, 9.0), (State.RETREAT, 10.0))
    enter(
        progress, "b", (State.SPAWN, 12.0), (State.DEPOSIT, 19.0), (State.RETREAT, 20.0), (State.RETURN, 21.0)
    )
    assert progress.placed == ["a", "b"]
    assert progress.placed_text(5) == "2 of 5, 10.0 s a box"  # 11 s and 9 s


def test_in_a_shift_boxes_are_counted_on_after_the_arm_had_nothing_to_do() -> None:
    progress = OrderProgress()
    for box, time in (("a", 1.0), ("b", 9.0)):
        visits = ((State.SPAWN, time), (State.DEPOSIT, time + 3.0), (State.RETREAT, time + 4.0))
        enter(progress, box, *visits, (State.DONE, time + 5.0))
    assert progress.placed == ["a", "b"]
    assert progress.placed_text() == "2, 5.0 s a box"


def test_a_box_that_is_left_where_it_was_or_set_aside_is_not_placed() -> None:
    progress = OrderProgress()
    enter(progress, "a", (State.GRIP_FAILED, 3.0), (State.RETREAT, 4.0))
    enter(progress, "b", (State.DEPOSIT, 9.0), (State.RETREAT, 10.0), place="reorientation_table")
    enter(progress, "b", (State.RETURN, 11.0))
    assert progress.placed_text() == "0"


def test_an_order_is_under_way_from_its_first_state_to_its_end() -> None:
    progress = OrderProgress()
    assert not progress.is_under_way
    enter(progress, "a", (State.SPAWN, 1.0))
    assert progress.is_under_way
    for end in ENDS:
        enter(progress, "a", (State.RETREAT, 5.0), (end, 6.0))
        assert not progress.is_under_way


def test_a_fault_stays_on_view_with_its_reason() -> None:
    progress = OrderProgress()
    progress.enter(State.BOX_LOST.label, "a", PALLET, "it slipped", 3.0)
    assert progress.is_fault
    progress.enter(State.SKIP_BOX.label, "a", PALLET, "", 3.0)
    assert "it slipped" in progress.states_html()


def test_the_ticks_of_a_plot_have_labels_that_differ_however_small_its_values_are() -> None:
    gui = Mock()
    RollingPlot(gui, "error [mm]", ("error",))
    for axis in gui.add_uplot.call_args.kwargs["axes"]:
        assert sorted(axis["incrs"]) == list(axis["incrs"])
        for distance in axis["incrs"]:  # uPlot writes three decimals
            assert len({f"{n * distance:.3f}" for n in range(10)}) == 10
