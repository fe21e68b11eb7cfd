"""What `pack up` does until a cell is ready, with shell commands as nodes."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from pack_bringup.graph import bring_up
from pack_bringup.graph.bring_up import wait_until_ready
from pack_bringup.graph.processes import ProcessGroup
from pack_core.errors import PackError

FAILS = [sys.executable, "-c", "import sys; print('error: no such scene', file=sys.stderr); sys.exit(2)"]
IGNORES_CTRL_C = ["sh", "-c", "trap '' INT; sleep 60"]
WAITS = ["sleep", "60"]


class Heard:
    """A listener to whom nobody speaks until it has been asked often enough."""

    def __init__(self, turns: int) -> None:
        self.turns = turns

    def unready(self, names: list[str]) -> dict[str, str]:
        self.turns -= 1
        return dict.fromkeys(names, "no /scene yet") if self.turns > 0 else {}

    def spin_until(self, condition: Callable[[], bool], timeout: float) -> bool:
        deadline = time.monotonic() + timeout
        while not condition():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.01)
        return True


def test_a_node_that_fails_at_start_is_named_with_its_reason_and_the_log_and_ends_the_others(
    tmp_path: Path,
) -> None:
    log = tmp_path / "cell.log"
    with (
        log.open("w") as output,
        ProcessGroup({"sim": FAILS, "mpc": IGNORES_CTRL_C}, output=output) as group,
    ):
        with pytest.raises(PackError) as failed:
            wait_until_ready(group, Heard(10**9), ["sim", "mpc"], log, print)
        assert group.wait(10), "the other is not ended"
    assert str(failed.value) == f"node 'sim' ended with exit code 2: no such scene (log: {log})"


def test_it_is_said_what_is_waited_for_when_it_takes_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bring_up, "REMIND_PERIOD", 0.05)
    said: list[str] = []
    log = tmp_path / "cell.log"
    with log.open("w") as output, ProcessGroup({"mpc": WAITS}, output=output) as group:
        wait_until_ready(group, Heard(30), ["mpc"], log, said.append)
        assert group.running == ["mpc"]
    assert said[0] == "waiting for mpc (no /scene yet)"
