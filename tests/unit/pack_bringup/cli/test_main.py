import os
import subprocess
import sys
from ctypes.util import find_library
from pathlib import Path

import pytest

from pack_bringup.cli.main import main
from pack_bringup.cli.up import ready_words
from pack_core.cells import CELLS
from pack_evaluation.provenance import project_version

PACK = [sys.executable, "-c", "from pack_bringup.cli.main import main; main()"]


def pack(*arguments: str) -> subprocess.CompletedProcess[str]:
    """The command line as a process, for what replaces it by another program."""
    return subprocess.run([*PACK, *arguments], capture_output=True, text=True)


class Called:
    """The command line called in this process: its exit code and what it printed."""

    def __init__(self, patch: pytest.MonkeyPatch, captured: pytest.CaptureFixture[str]) -> None:
        self._patch, self._captured = patch, captured

    def __call__(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        self._patch.setattr(sys, "argv", ["pack", *arguments])
        # the name of the program is argv's then, whether pytest is called as a command or as a module
        self._patch.setattr(sys.modules["__main__"], "__package__", None)
        with pytest.raises(SystemExit) as ended:
            main()
        said = self._captured.readouterr()
        code = ended.value.code if isinstance(ended.value.code, int) else 0
        return subprocess.CompletedProcess(arguments, code, said.out, said.err)


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Called:
    return Called(monkeypatch, capfd)


def test_pack_says_its_version_and_commit(call: Called) -> None:
    outcome = call("--version")
    assert outcome.returncode == 0
    assert outcome.stdout.startswith(f"PackCell {project_version()}, commit ")


@pytest.mark.parametrize("command", [(), ("up",), ("bag", "info"), ("benchmark", "blocks"), ("run",)])
def test_h_is_help_of_every_command(call: Called, command: tuple[str, ...]) -> None:
    assert call(*command, "-h").stdout == call(*command, "--help").stdout
    assert "Usage: " in call(*command, "-h").stdout


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("demo", "blocks", "--real-time-factor", "-1"), "-1; allowed: greater than or equal to 0"),
        (("play", "bag", "--rate", "fast"), "fast; allowed: a valid number"),
    ],
)
def test_an_option_out_of_bounds_says_what_was_given_and_what_is_allowed(
    call: Called, given: tuple[str, ...], words: str
) -> None:
    outcome = call(*given)
    assert outcome.returncode == 2
    said = " ".join(outcome.stderr.replace("│", " ").split())
    assert f"Invalid value for '{given[2]}': {words}" in said


@pytest.mark.parametrize("backend", ["osmesa", "spam"])
def test_an_opengl_that_cannot_be_loaded_is_one_line_that_names_the_variable(backend: str) -> None:
    if find_library("OSMesa") and backend == "osmesa":
        pytest.skip("it can be loaded here")
    command = [*PACK, "status"]
    environment = {**os.environ, "MUJOCO_GL": backend}
    environment.pop("PYOPENGL_PLATFORM", None)  # set in a process that has drawn
    ended = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert ended.returncode == 2
    (line,) = ended.stderr.strip().splitlines()
    assert f"MUJOCO_GL is '{backend}'" in line
    assert "MUJOCO_GL=egl" in line


@pytest.mark.parametrize("command", ["demo", "goal"])
def test_a_planner_that_is_not_there_is_refused_before_anything_is_started(
    call: Called, command: str
) -> None:
    ended = call(command, "blocks", "--method", "bem")
    assert ended.returncode == 2
    assert "'bem'; allowed: beam" in ended.stderr.replace("\n", " ")


def test_nodes_that_were_started_alone_are_not_said_to_take_a_goal() -> None:
    assert "pack goal packing --domain 7" in ready_words("packing", [], " --domain 7")
    alone = ready_words("packing", ["perception"], " --domain 7")
    assert "ready: perception" in alone
    assert "goal" not in alone


def test_the_first_help_names_every_cell(call: Called) -> None:
    said = call("--help").stdout
    assert all(cell in said for cell in CELLS)


def test_run_passes_arguments_on_as_they_are(prefix: Path) -> None:
    outcome = pack("run", "fruit", "peel", "--help", "--ros-args", "-p", "rate:=2 Hz", "--", "last")
    assert outcome.stdout.split("\n") == [
        "[--help]",
        "[--ros-args]",
        "[-p]",
        "[rate:=2 Hz]",
        "[--]",
        "[last]",
        "",
    ]


def test_run_drops_a_leading_separator(prefix: Path) -> None:
    assert pack("run", "fruit", "peel", "--", "--thin").stdout == "[--thin]\n"


@pytest.mark.parametrize(
    "arguments", [("run", "fruit", "slice"), ("run", "nut", "crack"), ("up", "juggling")]
)
def test_an_unknown_name_is_one_line_of_error_and_exit_code_2(
    prefix: Path, call: Called, arguments: tuple[str, ...]
) -> None:
    outcome = call(*arguments)
    assert outcome.returncode == 2
    assert outcome.stderr.startswith("error: ")
    assert outcome.stderr.count("\n") == 1


def test_executables_lists_package_and_executable_a_line(prefix: Path, call: Called) -> None:
    assert call("executables", "fruit").stdout == "fruit peel\n"
    assert "pack_sim sim_node" in call("executables").stdout.splitlines()


def test_wiring_lists_topics_services_and_actions(call: Called) -> None:
    page = call("wiring", "--markdown").stdout
    assert "| /clock | topic |" in page
    assert "| /plan_placement | service |" in page
    assert "| /pack_object | action |" in page


@pytest.mark.parametrize("command", ["run", "up", "executables", "wiring"])
def test_help_of_every_command_shows_how_to_call_it(call: Called, command: str) -> None:
    assert f"Usage: pack {command}" in call(command, "--help").stdout


def test_a_node_that_moves_the_arm_is_not_replayed(call: Called, tmp_path: Path) -> None:
    (tmp_path / "run.yaml").write_text("cell: blocks\n")
    outcome = call("replay", str(tmp_path), "--node", "fsm")
    assert outcome.returncode == 2
    assert outcome.stderr == "error: node 'fsm' of the cell blocks; allowed: rearrangement, tags\n"
