"""A folder that cannot take a run is refused before anything starts, and so is a goal that cannot be met."""

import os
import sys
from pathlib import Path

import pytest
import yaml

from pack_bringup.cli import up
from pack_bringup.cli.main import main
from pack_bringup.cli.options import page_process
from pack_bringup.cli.outputs import make_output_folder
from pack_bringup.graph.processes import ProcessGroup
from pack_core.errors import ConfigError
from pack_core.paths import config_path


@pytest.fixture(autouse=True)
def no_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that these tests call may come as far as to start a node."""

    def start(_: ProcessGroup) -> None:
        pytest.fail("a node was started")

    monkeypatch.setattr(ProcessGroup, "start", start)


def refusal_of(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The one line with which a command ends at once."""
    monkeypatch.setattr(sys, "argv", ["pack", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    said = capfd.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    return said


@pytest.mark.parametrize(
    ("command", "cell"),
    [("demo", "packing"), ("demo", "palletizing"), ("demo", "blocks"), ("benchmark", "palletizing")],
)
def test_a_place_that_cannot_be_made_is_refused_at_once(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], command: str, cell: str
) -> None:
    said = refusal_of(monkeypatch, capfd, command, cell, "--output", "/proc/x")
    assert "/proc/x" in said
    assert "--output" in said


def test_a_folder_of_an_earlier_run_is_refused_and_left_as_it_is(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "bag").mkdir()
    (tmp_path / "nodes.log").write_text("what was said")
    said = refusal_of(monkeypatch, capfd, "demo", "packing", "--output", str(tmp_path))
    assert "holds an earlier run (bag, nodes.log)" in said
    assert (tmp_path / "nodes.log").read_text() == "what was said"


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="File exists; give another --output"):
        make_output_folder(tmp_path / "file")


@pytest.mark.parametrize(
    "command",
    [
        ["order", "check", "config/orders/order_05.json", "--output"],
        ["order", "import", "config/orders/order_05.json", "--output"],
        ["layout", "config/orders/order_05.json", "--output"],
        ["evaluate", "bags/samples/packing", "--json"],
        ["benchmark", "packing", "--json"],
        ["benchmark", "faults", "packing", "--json"],
        ["soak", "packing", "--json"],
    ],
    ids=" ".join,
)
def test_a_file_that_is_given_as_a_folder_is_refused_before_the_work(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path, command: list[str]
) -> None:
    (tmp_path / "file").touch()
    target = tmp_path / "file" / "x.json" if command[-1] == "--json" else tmp_path / "file"
    monkeypatch.chdir(config_path().parent)
    said = refusal_of(monkeypatch, capfd, *command, str(target))
    assert said.startswith(f"error: cannot write into {tmp_path / 'file'}: ")
    assert said.endswith(f"; give another {command[-1]}\n")


def test_a_folder_is_no_json_file(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    said = refusal_of(monkeypatch, capfd, "evaluate", "bags/samples/packing", "--json", str(tmp_path))
    assert "it is a folder; give --json a file" in said


def test_a_cell_whose_log_cannot_be_written_is_not_started(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(up, "bags_path", lambda: Path("/proc/bags"))  # as in a checkout that is read only
    said = refusal_of(monkeypatch, capfd, "up", "packing")
    assert said.startswith("error: cannot write into /proc/bags/logs: ")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(ConfigError, match="Permission denied"):
        make_output_folder(tmp_path / "run")


def test_a_new_folder_is_made_and_an_empty_one_taken(tmp_path: Path) -> None:
    for _ in range(2):
        make_output_folder(tmp_path / "a" / "b", taken_by=["bag"])
        assert list((tmp_path / "a" / "b").iterdir()) == []


@pytest.mark.parametrize("command", ["demo", "goal"])
def test_a_problem_that_contradicts_itself_is_refused_at_once(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path, command: str
) -> None:
    problem = yaml.safe_load(config_path("scenarios", "blocks", "example.yaml").read_text())
    problem["blocks"][1]["goal"] = problem["blocks"][0]["goal"]
    file = tmp_path / "problem.yaml"
    file.write_text(yaml.safe_dump(problem))
    said = refusal_of(monkeypatch, capfd, command, "blocks", "--problem", str(file))
    assert str(file) in said
    assert "goal" in said


def test_the_palletizing_benchmark_takes_one_order_by_its_file(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    missing = str(tmp_path / "order.json")
    said = refusal_of(
        monkeypatch, capfd, "benchmark", "palletizing", "--order", missing, "-o", str(tmp_path / "results")
    )
    assert missing in said


@pytest.mark.parametrize(
    ("live", "port", "host", "token", "words"),
    [
        (True, 8210, "0.0.0.0", "", "give a token, too"),
        (True, 8210, "0.0.0.0", "short", "16 or more"),
        (False, 8211, "127.0.0.1", "", "without --live"),
        (False, 8210, "0.0.0.0", "", "without --live"),
    ],
)
def test_a_page_that_cannot_be_shown_is_refused_before_anything_starts(
    live: bool, port: int, host: str, token: str, words: str
) -> None:
    with pytest.raises(ConfigError, match=words):
        page_process("packing", live, port, host, token)
