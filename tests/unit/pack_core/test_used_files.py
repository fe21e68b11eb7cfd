"""Which files of the project a process used, and how a process that is started for a measurement tells it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pack_core.paths import config_path, project_root
from pack_core.used_files import VARIABLE, data_files, told

PROBE = """
import json
from pack_core.used_files import used_by_process, used_since_watch, watch
watch()
from pack_core.config import load_values
from pack_core.paths import config_path
list(config_path("orders").glob("*.json"))
load_values(config_path("cells", "packing.yaml"))
import pack_planner.rearrangement.planning
import pack_bringup.cli.terminal
print(json.dumps([sorted(used_since_watch()), sorted(used_by_process())]))
"""

TELLING = """
import os
from pack_core.used_files import tell_if_asked, watch_if_asked
watch_if_asked()
open(os.environ["READ_FIRST"]).close()
tell_if_asked()
open(os.environ["READ_THEN"]).close()
if os.environ["ENDS"] == "well":
    tell_if_asked()
os._exit(9)
"""
CELL, GRAPH = config_path("cells", "packing.yaml"), config_path("graphs", "packing.yaml")


def test_modules_files_and_folders_that_a_process_used_are_known() -> None:
    answer = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True, check=True)
    since, everything = json.loads(answer.stdout)
    for used in ("config/orders/", "config/cells/packing.yaml"):
        assert used in since, since
    assert "ros_ws/src/pack_planner/pack_planner/rearrangement/planning.py" in since
    before = "ros_ws/src/pack_core/pack_core/used_files.py"
    assert before not in since
    assert before in everything
    assert set(since) <= set(everything)
    for elsewhere in ("pack_bringup", "pack_viewer", "pallet_fsm", "pack_mpc", "__pycache__"):
        assert not [path for path in everything if elsewhere in path], elsewhere
    assert all((project_root() / path).exists() for path in everything)


def test_data_of_the_project_count_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "config").mkdir()
    link = tmp_path / "link.yaml"
    link.symlink_to(CELL)
    module, folder = Path(data_files.__code__.co_filename), CELL.parent
    given = [
        str(path) for path in (CELL, folder, link, module, tmp_path / "config", project_root() / "README.md")
    ]
    assert data_files(given) == {"config/cells/packing.yaml", "config/cells/"}


@pytest.mark.parametrize(("ends", "told_of"), [("well", {CELL, GRAPH}), ("hard", {CELL})])
def test_what_a_process_used_is_told_until_it_last_could(
    ends: str, told_of: set[Path], tmp_path: Path
) -> None:
    environment = {
        "READ_FIRST": str(CELL),
        "READ_THEN": str(GRAPH),
        "ENDS": ends,
        VARIABLE: str(tmp_path / "used"),
    }
    for _ in range(2):  # a second process, as of a node that is started again, adds to the first
        subprocess.run([sys.executable, "-c", TELLING], env={**os.environ, **environment}, check=False)
    found = told(tmp_path / "used")
    assert "ros_ws/src/pack_core/pack_core/used_files.py" in found
    assert {path for path in found if path.startswith("config")} == {
        str(path.relative_to(project_root())) for path in told_of
    }
    assert len(list((tmp_path / "used").iterdir())) == 2


def test_a_process_that_is_not_asked_tells_nothing(tmp_path: Path) -> None:
    environment = {"READ_FIRST": str(CELL), "READ_THEN": str(GRAPH), "ENDS": "well"}
    outside = {name: value for name, value in os.environ.items() if name != VARIABLE}
    done = subprocess.run(
        [sys.executable, "-c", TELLING],
        env={**outside, **environment},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (9, "")
    assert list(tmp_path.iterdir()) == []
    assert told(tmp_path / "nothing") == frozenset()
