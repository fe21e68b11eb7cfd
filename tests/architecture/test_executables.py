"""Node files, entry points and graph files name the same executables."""

import ast
from importlib.metadata import entry_points
from pathlib import Path

import pytest
import yaml

from pack_bringup.graph.executables import executables_of
from pack_bringup.graph.graph import load_graph
from pack_core.paths import config_path, project_root

SOURCES = project_root() / "ros_ws" / "src"
PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/setup.py"))
CELLS = sorted(path.stem for path in config_path("graphs").glob("*.yaml"))


def groups_of(package: str) -> dict[str, list[str]]:
    """Entry points of every group, `name = module:attribute`, as setup.py has them."""
    tree = ast.parse((SOURCES / package / "setup.py").read_text())
    keywords = (node for node in ast.walk(tree) if isinstance(node, ast.keyword))
    found = [ast.literal_eval(keyword.value) for keyword in keywords if keyword.arg == "entry_points"]
    return dict(*found)


def scripts_of(package: str) -> dict[str, str]:
    """Executable name to `module:function`."""
    return dict(line.split(" = ") for line in groups_of(package).get("console_scripts", []))


@pytest.mark.parametrize("package", PACKAGES)
def test_every_node_file_is_an_entry_point_and_every_entry_point_a_file(package: str) -> None:
    paths = (SOURCES / package / package).rglob("*_node.py")
    files = {path.stem for path in paths if "ros" not in path.parent.parts}
    scripts = scripts_of(package)
    assert {name for name in scripts if name.endswith("_node")} == files
    for name, target in scripts.items():
        module, function = target.split(":")
        path = SOURCES / package / Path(*module.split(".")).with_suffix(".py")
        assert f"def {function}(" in path.read_text(), name


@pytest.mark.parametrize("package", PACKAGES)
def test_every_entry_point_is_installed(package: str) -> None:
    assert {path.name for path in executables_of(package)} == set(scripts_of(package))


@pytest.mark.parametrize("package", PACKAGES)
def test_what_a_package_registers_is_installed_and_there(package: str) -> None:
    for group, lines in groups_of(package).items():
        installed = {f"{entry.name} = {entry.value}": entry for entry in entry_points(group=group)}
        assert set(lines) <= set(installed), "make setup"
        if group != "console_scripts":
            assert all(installed[line].load() for line in lines)


@pytest.mark.parametrize("cell", CELLS)
def test_every_node_of_a_graph_can_be_started(cell: str) -> None:
    graph = load_graph(cell)
    assert graph.nodes
    for node in graph.nodes:
        assert Path(node.command()[0]).is_file()


@pytest.mark.parametrize("cell", CELLS)
def test_every_parameter_file_is_for_the_node_that_the_graph_names(cell: str) -> None:
    for node in load_graph(cell).nodes:
        data = yaml.safe_load(node.parameters_path.read_text())
        assert set(data) <= {node.name, f"/{node.name}", "/**"}, node.parameters_path
        assert all(set(section) == {"ros__parameters"} for section in data.values())
