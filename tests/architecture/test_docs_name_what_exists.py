"""Every link, path, command and option that the pages name exists."""

from __future__ import annotations

import re
from fnmatch import filter as matching
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from architecture.doc_pages import Page, pages, split
from pack_bringup.cli.main import app
from pack_bringup.graph.executables import executables_of
from pack_bringup.graph.graph import load_graph
from pack_core.cells import CELLS
from pack_core.paths import project_root
from pack_core.ros.contracts.table import wiring_of

ROOT = project_root()
PAGES = pages()
NOT_OURS = re.compile(
    r"\bthing|\bmy[_.]|<run>|^bags/(?!samples|README)"  # the reader's own files and recordings
    r"|^\.venv/|^ros_ws/(build|install|log)/"  # what set-up makes
    r"|^example_data/|^3d_rectangular/"  # files of the projects that the orders come from
    r"|^std_srvs/"  # types of ROS 2
)
INTERFACE_TYPE = re.compile(r"\w+/(msg|srv|action)/\w+")
"""The type of a message, service or action: the path of its file, without the file's ending."""
MADE_BY_A_RUN = ("bag/", "plots/", "pictures/", "runs/", "scenes/", "failures/")
"""Folders inside a run's or a benchmark's results."""
OTHER_PROGRAMS = {"--symlink-install", "--ros-args", "--params-file", "-p", "-m", "-s", "-n", "-k", "-x"}
"""Options of colcon, ROS 2 and pytest that pages name without a command."""
FOLDERS = (".ci", "bags/samples", "config", "docs", "requirements", "ros_ws/src", "tests", "tools")
PAGE_IN_CODE = re.compile(r"\b(?:docs|config|bags)/[\w/]+\.md\b")
on_every_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.path.relative_to(ROOT)))


@pytest.fixture(scope="module")
def files() -> list[str]:
    """The project's own files."""
    folders = [ROOT / name for name in FOLDERS]
    found = [path for folder in folders for path in folder.rglob("*") if "__pycache__" not in path.parts]
    return [str(path.relative_to(ROOT)) for path in [*found, *ROOT.glob("*")] if path.is_file()]


@pytest.fixture(scope="module")
def names(files: list[str]) -> set[str]:
    """Every file, every folder above one, and both without any of their leading folders."""
    found: set[str] = set()
    for file in files:
        parts = file.split("/")
        found |= {"/".join(parts[i:j]) for j in range(1, len(parts) + 1) for i in range(j)}
    return found


def command_tree() -> dict[str, Any]:
    """Every command of `pack` by its words, e.g. `demo packing`."""
    found: dict[str, Any] = {}

    def walk(command: Any, words: tuple[str, ...]) -> None:
        found[" ".join(words)] = command
        for name, below in getattr(command, "commands", {}).items():
            walk(below, (*words, name))

    walk(typer.main.get_command(app), ())
    return found


COMMANDS = command_tree()


def options_of(command: Any) -> set[str]:
    given = {name for parameter in command.params for name in (*parameter.opts, *parameter.secondary_opts)}
    return {name for name in given if name.startswith("-")} | {"--help"}


def wrong_in_pack(arguments: list[str]) -> str:
    """What `pack ARGUMENTS` names that does not exist; nothing where all is well."""
    words: list[str] = []
    while arguments and " ".join([*words, arguments[0]]) in COMMANDS:
        words.append(arguments.pop(0))
    command = COMMANDS[" ".join(words)]
    is_group = hasattr(command, "commands")
    if is_group and arguments and arguments[0].islower() and not arguments[0].startswith("-"):
        return f"no command {' '.join([*words, arguments[0]])}"
    if words == ["run"]:
        return wrong_executable(arguments[2:] if arguments[:1] == ["--network"] else arguments)
    if words == ["up"] and arguments and arguments[0] in CELLS:
        nodes = {node.name for node in load_graph(arguments[0]).nodes}
        only = [value for option, value in pairwise(arguments) if option == "--only"]
        if set(only) - nodes:
            return f"no node {set(only) - nodes} in the graph of {arguments[0]}"
    unknown = {word for word in arguments if re.match(r"--?[a-z]", word)} - options_of(command)
    return f"no option {unknown} of pack {' '.join(words)}" if unknown else ""


def wrong_executable(arguments: list[str]) -> str:
    """What is wrong with PACKAGE EXECUTABLE ...; a placeholder in angle brackets stands for any."""
    if len(arguments) < 2 or "<" in arguments[0]:
        return ""
    package, executable = arguments[:2]
    there = {path.name for path in executables_of(package)}
    return "" if executable in there else f"no executable {executable} in {package}; there are {there}"


@pytest.mark.parametrize("words", COMMANDS)
def test_every_command_shows_its_help_and_on_80_columns_it_cuts_no_word(words: str) -> None:
    outcome = CliRunner().invoke(app, [*words.split(), "--help"], env={"COLUMNS": "80"})
    assert outcome.exit_code == 0, outcome.output
    assert "Usage: " in outcome.output
    assert [line for line in outcome.output.splitlines() if "…" in line] == []


@pytest.mark.parametrize("words", COMMANDS)
def test_what_a_commands_help_calls_exists(words: str) -> None:
    spans = re.findall(r"`pack ([^`]+)`", COMMANDS[words].help or "")
    assert [wrong for span in spans if (wrong := wrong_in_pack(split(span)))] == []


@on_every_page
def test_links_lead_somewhere(page: Page) -> None:
    broken = []
    for link in page.links:
        place, _, anchor = link.partition("#")
        target = (page.path.parent / place).resolve() if place else page.path
        if not target.exists() or (anchor and anchor not in Page(target).anchors):
            broken.append(link)
    assert broken == []


@on_every_page
def test_paths_exist(page: Page, names: set[str]) -> None:
    for path in page.paths:
        if NOT_OURS.search(path) or path.startswith(MADE_BY_A_RUN):
            continue
        pattern = re.sub(r"<\w+>", "*", path.removeprefix("./")).rstrip("/")
        if INTERFACE_TYPE.fullmatch(path):
            pattern += ".*"
        beside = [place for base in (page.path.parent, ROOT) for place in base.glob(pattern)]
        assert beside or matching(names, pattern), f"{path}: neither beside the page nor in the project"


@on_every_page
def test_commands_of_pack_and_their_options_exist(page: Page) -> None:
    assert [wrong for arguments in page.commands("pack") if (wrong := wrong_in_pack(arguments))] == []


@on_every_page
def test_executables_of_ros2_run_exist(page: Page) -> None:
    calls = [arguments[1:] for arguments in page.commands("ros2") if arguments[:1] == ["run"]]
    assert [wrong for arguments in calls if (wrong := wrong_executable(arguments))] == []


@on_every_page
def test_targets_and_variables_of_make_exist(page: Page) -> None:
    makefile = (ROOT / "Makefile").read_text()
    targets = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
    variables = set(re.findall(r"^([A-Z]+) \?=|\$\(([A-Z]+)\)", makefile, re.MULTILINE))
    for arguments in page.commands("make"):
        given = [word.partition("=")[0] for word in arguments if "=" in word]
        assert set(given) <= {name for pair in variables for name in pair}
        assert {word for word in arguments if "=" not in word} <= targets
        if "demo" in arguments:
            values = dict(word.split("=", 1) for word in arguments if "=" in word)
            call = ["demo", values.get("CELL", "packing"), *split(values.get("ARGS", ""))]
            assert wrong_in_pack(call) == ""


@on_every_page
def test_options_named_alone_are_of_some_command(page: Page) -> None:
    known = set().union(*map(options_of, COMMANDS.values())) | OTHER_PROGRAMS
    assert set(page.options) - known == set()


@on_every_page
def test_topics_services_and_actions_are_wired(page: Page) -> None:
    wired = {contract.name for cell in CELLS for contract in wiring_of(cell)}
    named = {span for span in page.spans if re.fullmatch(r"/[a-z_]+(/[a-z_]+)*", span)}
    assert {name for name in named - wired if not name.startswith(("/opt/", "/dev/", "/tmp"))} == set()


def test_pages_that_the_code_names_exist(files: list[str]) -> None:
    missing = []
    for file in files:
        if file.endswith((".py", ".yaml", ".xml", ".sh", ".bash", ".toml", "Makefile")):
            pages_named = PAGE_IN_CODE.findall((ROOT / file).read_text())
            missing += [f"{file}: {page}" for page in pages_named if not Path(ROOT, page).is_file()]
    assert missing == []
