"""Nodes that die are started again, but not for ever."""

from __future__ import annotations

import io
import signal
import sys

import pytest

from pack_bringup.graph.processes import MOST, SPAN, ProcessGroup, Restarts
from pack_core.errors import PackError

WAITS = ["sleep", "60"]
FAILS = [sys.executable, "-c", "import sys; sys.exit(3)"]
ENDS = [sys.executable, "-c", ""]


def test_a_killed_node_runs_again_as_another_process_and_the_others_are_left_alone() -> None:
    said: list[str] = []
    with ProcessGroup({"sim": WAITS, "mpc": WAITS}, output=io.StringIO()) as group:
        restarts, first, other = Restarts(group, said.append), group.pid("sim"), group.pid("mpc")
        restarts.restart_dead()
        assert said == []
        group.signal("sim", signal.SIGKILL)
        assert group.wait(10, count=1)
        restarts.restart_dead()
        assert group.running == ["sim", "mpc"]
        assert group.pid("sim") != first
        assert group.pid("mpc") == other
        assert said == ["node 'sim' died (exit code -9) and was started again, restart 1"]


def test_a_node_that_keeps_dying_is_given_up_and_another_minute_begins_anew() -> None:
    said: list[str] = []
    now = 0.0
    with ProcessGroup({"sim": FAILS, "mpc": WAITS}, output=io.StringIO()) as group:
        restarts = Restarts(group, said.append, lambda: now)
        for k in range(MOST):
            now = SPAN * k  # far enough apart to be counted alone
            assert group.wait(10, count=1)
            restarts.restart_dead()
        for _ in range(MOST + 1):
            assert group.wait(10, count=1)
            restarts.restart_dead()
        assert [line[-9:] for line in said[: 2 * MOST - 1]] == ["restart 1"] * MOST + [
            "restart 2",
            "restart 3",
        ]
        assert "it stays ended" in said[-1]
        count = len(said)
        restarts.restart_dead()
        assert len(said) == count


def test_a_node_that_ended_in_order_stays_ended() -> None:
    said: list[str] = []
    with ProcessGroup({"sim": ENDS, "mpc": WAITS}, output=io.StringIO()) as group:
        assert group.wait(10, count=1)
        Restarts(group, said.append).restart_dead()
        assert group.exit_codes == {"sim": 0}
    assert said == []


def test_a_process_that_runs_is_not_started_a_second_time() -> None:
    with (
        ProcessGroup({"sim": WAITS}, output=io.StringIO()) as group,
        pytest.raises(PackError, match="still runs"),
    ):
        group.restart("sim")
