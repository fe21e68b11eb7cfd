"""Node files, entry points and graph files name the same executables."""

import ast
from pathlib import Path

import pytest
import yaml

from pack_bringup.graph.executables import executables_of
from pack_bringup.graph.graph import load_graph
from pack_core.paths import config_path, project_root

SOURCES = project_root() / "ros_ws" / "src"
PACKAGES = sorted(path.parent.name for path in SOURCES.glob("*/setup.py"))
CELLS = sorted(path.stem for path in config_path("graphs").glob("*.yaml"))


def entry_points(package: str) -> dict[str, str]:
    """Executable name to `module:function`, as setup.py has them."""
    tree = ast.parse((SOURCES / package / "setup.py").read_text())
    texts = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    lines = [text for text in texts if isinstance(text, str) and " = " in text]
    return dict(line.split(" = ") for line in lines)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_node_file_is_an_entry_point_and_every_entry_point_a_file(package: str) -> None:
    paths = (SOURCES / package / package).rglob("*_node.py")
    files = {path.stem for path in paths if "ros" not in path.parent.parts}
    points = entry_points(package)
    assert {name for name in points if name.endswith("_node")} == files
    for name, target in points.items():
        module, function = target.split(":")
        path = SOURCES / package / Path(*module.split(".")).with_suffix(".py")
        assert f"def {function}(" in path.read_text(), name


@pytest.mark.parametrize("package", PACKAGES)
def test_every_entry_point_is_installed(package: str) -> None:
    assert {path.name for path in executables_of(package)} == set(entry_points(package))


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
