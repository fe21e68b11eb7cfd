import json
import re
import shutil
import signal
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from e2e.command import alarms, output_of, pack
from e2e.packing.cell import EASY_SCENE
from pack_bringup.cli.main import app
from pack_core.errors import PackError
from pack_core.packing.scene_file import load_scene
from pack_core.paths import ROOT_VARIABLE, project_root
from pack_evaluation.packing.from_bag import load_run

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A run with the easy scene: its folder, and what was printed."""
    folder = tmp_path_factory.mktemp("demo") / "run"
    # Half the processor is another worker's: in real time the arm would move on late plans, and may fail.
    slowly = ("--real-time-factor", "0.25")
    process = pack("demo", "packing", "--scene", EASY_SCENE, "--seed", "4", *slowly, "--output", folder)
    text = output_of(process)
    assert process.returncode == 0, text
    return folder, text


def test_the_demo_packs_the_object_and_leaves_everything_behind(demo: tuple[Path, str]) -> None:
    folder, text = demo
    assert "placed" in text
    assert {path.name for path in folder.iterdir()} == {
        "bag", "nodes.log", "plots", "replay.html", "report.html", "run.mp4", "run.yaml", "scene.yaml",
    }  # fmt: skip
    assert yaml.safe_load((folder / "run.yaml").read_text())["seed"] == 4
    run = load_run(folder)
    assert imageio_ffmpeg.count_frames_and_secs(folder / "run.mp4")[1] > run.end - run.start


def test_a_healthy_start_run_and_end_log_no_error(demo: tuple[Path, str]) -> None:
    assert alarms(demo[0]) == []


def test_the_scene_that_was_recorded_is_the_one_that_was_run(demo: tuple[Path, str]) -> None:
    given, recorded = load_scene(EASY_SCENE), load_scene(demo[0] / "scene.yaml")
    assert recorded.description() == given.description()
    for name, X_WO in given.poses().items():
        assert np.linalg.norm(recorded.poses()[name].p - X_WO.p) < 1e-3


def test_evaluating_the_bag_again_prints_the_same_table(demo: tuple[Path, str], tmp_path: Path) -> None:
    folder, text = demo
    measures = tmp_path / "measures.json"
    words = ["evaluate", folder / "bag", "--no-video", "--output", tmp_path, "--json", measures]
    again = CliRunner().invoke(app, list(map(str, words)))
    assert again.exit_code == 0, again.output
    table = [line for line in again.output.splitlines() if line.startswith("│")]
    assert len(table) > 10
    assert table == [line for line in text.splitlines() if line.startswith("│")]
    assert json.loads(measures.read_text())["success"] is True


def test_ctrl_c_ends_all_nodes_and_keeps_what_was_recorded(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    process = pack("demo", "packing", "--scene", EASY_SCENE, "--output", folder)
    assert process.stdout is not None
    next(line for line in process.stdout if line.startswith("INSERT"))
    process.send_signal(signal.SIGINT)
    text = output_of(process)
    assert "stopped; what was recorded is in" in text
    assert process.returncode == 130, text
    log = (folder / "nodes.log").read_text()
    assert log.count("ended with exit code 0") == 5
    assert not load_run(folder).is_cut


def test_a_bad_scene_file_is_named_before_anything_is_started(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(EASY_SCENE.read_text().replace("friction: 0.4", "friction: -1"))
    words = ["demo", "packing", "--scene", scene, "--output", tmp_path / "run"]
    outcome = CliRunner().invoke(app, list(map(str, words)))
    assert isinstance(outcome.exception, PackError)  # one line and exit code 2
    assert "friction" in str(outcome.exception)
    assert not (tmp_path / "run").exists()


def test_a_node_that_does_not_come_up_is_named_with_its_last_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(project_root() / "config", tmp_path / "config")
    parameters = tmp_path / "config" / "nodes" / "packing" / "recorder.yaml"
    parameters.write_text(parameters.read_text().replace("split_mb", "spilt_mb"))
    graph = tmp_path / "config" / "graphs" / "packing.yaml"
    # the others would be started for nothing
    needed = (
        line for line in graph.read_text().splitlines() if not re.search("perception|planner|mpc", line)
    )
    graph.write_text("\n".join(needed))
    monkeypatch.setenv(ROOT_VARIABLE, str(tmp_path))
    process = pack("demo", "packing", "--scene", EASY_SCENE, "--output", tmp_path / "run")
    text = output_of(process)
    assert process.returncode == 2
    assert "node 'recorder' ended with exit code 2" in text
    assert "did you mean 'split_mb'" in text
