"""A node that is started with something it does not allow says so in one line and ends."""

from __future__ import annotations

import runpy
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from integration.harness import Graph
from pack_bringup.graph.executables import find_executable
from pack_core.errors import ConfigError
from pack_core.paths import config_path
from pack_planner.placement.planner_node import PlannerNode

EXAMPLE = config_path("scenarios", "packing", "example.yaml")


LastWords = Callable[..., str]


@pytest.fixture
def last_words(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Iterator[LastWords]:
    """Runs an executable in this process until it ends with exit code 2; the one line that it prints."""
    handler, interval = signal.getsignal(signal.SIGINT), sys.getswitchinterval()
    monkeypatch.setattr("faulthandler.enable", lambda _: None)  # where a crash is reported is pytest's to say

    def run(package: str, executable: str, *parameters: str) -> str:
        path = str(find_executable(package, executable))
        options = [word for parameter in parameters for word in ("-p", parameter)]
        monkeypatch.setattr(sys, "argv", [path, "--ros-args", *options])
        with pytest.raises(SystemExit) as ended:
            runpy.run_path(path, run_name="__main__")
        said = capfd.readouterr().err
        assert ended.value.code == 2, said
        (line,) = said.splitlines()
        return line

    yield run
    signal.signal(signal.SIGINT, handler)
    sys.setswitchinterval(interval)


@pytest.mark.parametrize(
    ("node", "parameter", "parts"),
    [
        ("sim", "real_time_factor:=-1.0", ("real_time_factor", "-1.0", "greater than or equal to 0")),
        ("sim", "real_time_factor:=fast", ("real_time_factor", "fast", "number")),
        ("sim", "mocap.min_cameras:=0", ("mocap.min_cameras", "0", "greater than 0")),
        ("sim", "scene:=missing.yaml", ("missing.yaml", "no such file")),
        ("perception", "min_rate:=0.0", ("min_rate", "0.0", "greater than 0")),
        ("planner", "samples:=0", ("samples", "0", "greater than")),
        ("mpc", "controller.threads:=0", ("controller.threads", "0", "greater than or equal to 1")),
        ("mpc", "weights:=heavy", ("weights", "heavy", "table_1, table_1_integral, table_1_norms, tuned")),
    ],
)
def test_a_bad_parameter_is_named_with_its_value_and_what_is_allowed(
    last_words: LastWords, node: str, parameter: str, parts: tuple[str, ...]
) -> None:
    line = last_words(f"pack_{node}", f"{node}_node", parameter)
    assert line.startswith("error: ")
    for part in parts:
        assert part in line


def test_a_bad_scene_file_is_named_with_its_key_and_what_is_allowed(tmp_path: Path) -> None:
    """As a process, which must also end: a thread that goes on would keep it."""
    path = tmp_path / "scene.yaml"
    path.write_text(EXAMPLE.read_text().replace("height: 0.110", "height: tall"))
    command = [str(find_executable("pack_sim", "sim_node")), "--ros-args", "-p", f"scene:={path}"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60.0, check=False)
    assert ended.returncode == 2, ended.stderr
    (line,) = ended.stderr.splitlines()
    for part in ("error: ", str(path), "objects.0", "height", "tall", "number"):
        assert part in line


def test_an_unknown_parameter_is_refused_with_what_may_have_been_meant(graph: Graph) -> None:
    graph.start(PlannerNode, smaples=3)
    with pytest.raises(ConfigError, match="no parameter 'smaples'; did you mean 'samples'"):
        graph.wait_until(lambda: False)


def test_what_is_known_is_not_refused(graph: Graph) -> None:
    node = graph.start(PlannerNode, samples=3)
    graph.wait_until(lambda: node.count_publishers("/alive/planner"))
