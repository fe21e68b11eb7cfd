"""A cell that is left running: started, looked at, given a goal and ended from several terminals."""

from __future__ import annotations

import re
import signal
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from e2e.command import output_of, pack
from e2e.packing.cell import EASY_SCENE
from integration.harness import own_domain
from pack_bringup.cli.main import app
from pack_core.errors import PackError
from pack_core.paths import bags_path
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.run import Run

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(400)]
START_TIMEOUT = 200.0
"""A first start compiles [s]."""


@dataclass
class Up:
    """A cell that runs until the test has ended it."""

    process: subprocess.Popen[str]
    domain: str
    said: list[str]

    def read_until(self, text: str) -> str:
        """The line with this text, the next that comes."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.said.append(line)
            if text in line:
                return line
        raise AssertionError("".join(self.said))


@pytest.fixture
def up(tmp_path: Path) -> Iterator[Up]:
    """The packing cell with the easy scene, slow enough for two workers, ready for a goal."""
    domain = str(own_domain())
    settings = (f"sim.scene={EASY_SCENE}", "sim.real_time_factor=0.25", f"recorder.path={tmp_path / 'run'}")
    options = [word for setting in settings for word in ("--set", setting)]
    cell = Up(pack("up", "packing", "--domain", domain, *options), domain, [])
    yield cell
    cell.process.kill()
    cell.process.wait()


def test_a_cell_says_that_it_is_ready_takes_a_goal_and_ends_without_an_alarm(up: Up, tmp_path: Path) -> None:
    ready = up.read_until("ready: ")
    assert f"`pack goal packing --domain {up.domain}`" in ready

    other = pack("up", "blocks", "--domain", up.domain)
    assert "the packing cell (mpc, perception, planner, recorder, sim) runs there" in output_of(other)
    assert other.returncode == 2

    shown = CliRunner().invoke(app, ["status", "--domain", up.domain]).output
    assert len(re.findall(r"│ (sim|perception|planner|mpc|recorder) +│.*│ ready ", shown)) == 5, shown

    goal = pack("goal", "packing", "--domain", up.domain, "--scene", EASY_SCENE, "--seed", "4")
    said = output_of(goal)
    assert goal.returncode == 0, said
    assert "INSERT" in said
    assert "goal ended: placed" in said

    up.process.send_signal(signal.SIGINT)
    rest = output_of(up.process)
    assert up.process.returncode == 0, rest
    assert rest.count("ended with exit code 0") == 5
    _check_recording(load_run(tmp_path / "run"))
    (log,) = {line for line in (bags_path() / "logs").iterdir() if str(tmp_path) in line.read_text()}
    assert not re.search(r"ERROR|Traceback|Failed to|error:", log.read_text())
    log.unlink()


def _check_recording(run: Run) -> None:
    """The goal is in the bag from its start to its end, and the time before it, but for 2 s, is not."""
    assert run.outcome["exit_reason"] == "placed"
    goal = run.joint_times[(run.joint_times >= run.start) & (run.joint_times <= run.end)]
    assert goal[0] - run.start < 0.01
    assert run.end - goal[-1] < 0.01
    assert np.diff(goal).max() < 0.02  # ten sensor periods: nothing of the goal is missing
    assert run.start - run.joint_times[0] < 2.5  # at a real-time factor below 1


def test_a_node_that_fails_at_start_ends_the_cell_with_its_reason_and_the_log() -> None:
    some = ("--only", "sim", "--only", "recorder")
    failing = pack("up", "packing", "--domain", str(own_domain()), *some, "--set", "sim.sed=3")
    said = output_of(failing)
    assert failing.returncode == 2, said
    last = said.splitlines()[-1]
    assert "node 'sim' ended with exit code 2: node 'sim' has no parameter 'sed'; did you mean 'seed'" in last
    log = Path(re.search(r"\(log: (.*)\)", last).group(1))
    assert "no parameter 'sed'" in log.read_text()
    log.unlink()


def test_a_goal_for_a_cell_that_does_not_run_names_what_starts_it() -> None:
    sent = CliRunner().invoke(app, ["goal", "palletizing", "--domain", str(own_domain())])
    assert isinstance(sent.exception, PackError)  # one line and exit code 2
    assert "`pack up palletizing` starts it" in str(sent.exception)
