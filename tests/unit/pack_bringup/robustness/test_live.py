"""Goals in real time: which seeds, what is reported of a goal, and the programs beside it."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from pack_bringup.graph.graph import load_graph
from pack_bringup.pace import Pace
from pack_bringup.robustness.live import (
    BUSY,
    GOAL_COLUMNS,
    busy_processes,
    goal_report,
    goal_row,
    seeds_of,
    summary,
)
from pack_core.cells import CELLS, cell_part
from pack_core.errors import ConfigError


def busy() -> int:
    """How many children of this process are the busy program."""
    wanted = "\0".join(BUSY)
    return sum(_command(path).startswith(wanted) and _parent(path) == os.getpid() for path in _processes())


def busy_at_last(wanted: int) -> int:
    """How many they are once they are as many as wanted, or after 30 s.

    A process that was just begun has the command line of its parent until it runs the program.
    """
    deadline = time.monotonic() + 30.0
    while (found := busy()) != wanted and time.monotonic() < deadline:
        pass
    return found


def _processes() -> list[Path]:
    return [path for path in Path("/proc").iterdir() if path.name.isdigit()]


def _command(path: Path) -> str:
    try:
        return (path / "cmdline").read_text()
    except OSError:
        return ""


def _parent(path: Path) -> int:
    try:
        return int((path / "stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return -1


@pytest.mark.parametrize(
    ("text", "seeds"), [("0..9", range(10)), ("7", [7]), ("3..3", [3]), ("10..12", [10, 11, 12])]
)
def test_seeds_are_the_first_to_the_last(text: str, seeds: list[int]) -> None:
    assert list(seeds_of(text)) == list(seeds)


@pytest.mark.parametrize("text", ["", "..", "3..", "..3", "9..0", "-1", "1.5", "a..b", "0..3..5"])
def test_other_seeds_are_refused_with_what_is_allowed(text: str) -> None:
    with pytest.raises(ConfigError, match=r"allowed: a seed, or the first and the last as in 0\.\.9"):
        seeds_of(text)


def test_busy_programs_run_meanwhile_and_no_longer() -> None:
    before = busy()
    with busy_processes(2):
        assert busy_at_last(before + 2) == before + 2
    assert busy() == before
    with busy_processes(0):
        assert busy() == before


def test_a_report_tells_median_and_late_iterations() -> None:
    pace = Pace(1.0, (0.9, 1.0), (20.0, 30.0, 40.0, 100.0))
    report = goal_report(3, True, "within 15 mm", pace)
    assert report["factor"] == pytest.approx(0.95)
    assert report["iteration_ms"]["median"] == pytest.approx(35.0)
    assert report["late_percent"] == pytest.approx(25.0)
    row = dict(zip(GOAL_COLUMNS, goal_row(report), strict=True))
    assert row["ended"] == "success"
    assert row["real-time factor"] == "0.950"
    assert row["over 96 ms"] == "25.0 %"


def test_a_goal_whose_nodes_died_counts_as_one_that_did_not_succeed() -> None:
    died = goal_report(1, False, "mpc ended with -9", None)
    found = summary([goal_report(0, True, "", Pace(1.0, (0.98,))), died])
    assert (found["goals"], found["succeeded"]) == (2, 1)
    assert found["not_succeeded"] == [{"seed": 1, "message": "mpc ended with -9"}]
    assert found["factor"]["mean"] == found["least_factor"] == pytest.approx(0.98)
    assert goal_row(died)[1:] == ("mpc ended with -9", "", "", "")


@pytest.mark.parametrize("cell", CELLS)
def test_a_seeded_job_has_the_seeded_goal_and_parameters_of_nodes_that_there_are(
    cell: str, tmp_path: Path
) -> None:
    job = cell_part(cell, "seeded_job")(
        5, tmp_path, real_time_factor=0.7, preset="", command="pack benchmark live"
    )
    assert job.goal() == cell_part(cell, "seeded_goal")(5).goal()
    overrides = job.overrides()
    assert overrides["sim"]["real_time_factor"] == "0.7"
    assert overrides.keys() <= {node.name for node in load_graph(cell).nodes}


def test_conditions_that_there_are_not_are_refused(tmp_path: Path) -> None:
    for cell in CELLS:
        with pytest.raises(ConfigError, match="allowed"):
            cell_part(cell, "seeded_job")(
                0, tmp_path, real_time_factor=None, preset="perfect", command=""
            ).overrides()
