"""The launch file, with stand-ins for launch and launch_ros, which the wheels do not bring."""

import importlib.util
import sys
from types import ModuleType, SimpleNamespace

import pytest

from pack_bringup.graph.graph import load_graph
from pack_core.cells import CELLS
from pack_core.paths import project_root

FILE = project_root() / "ros_ws" / "src" / "pack_bringup" / "launch" / "cell.launch.py"


class Recorded(SimpleNamespace):
    """Keeps what it is made with; as a substitution it reads the context."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        super().__init__(args=args, **kwargs)

    def perform(self, context: dict[str, str]) -> str:
        return context[self.args[0]]


@pytest.fixture
def launch_file(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    names = {
        "launch": ("LaunchContext", "LaunchDescription"),
        "launch.actions": ("DeclareLaunchArgument", "OpaqueFunction"),
        "launch.substitutions": ("LaunchConfiguration",),
        "launch_ros": (),
        "launch_ros.actions": ("Node",),
    }
    for name, classes in names.items():
        module = ModuleType(name)
        for one in classes:
            setattr(module, one, Recorded)
        monkeypatch.setitem(sys.modules, name, module)
    spec = importlib.util.spec_from_file_location("cell_launch", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_registered_cell_can_be_chosen(launch_file: ModuleType) -> None:
    arguments = launch_file.generate_launch_description().args[0][:-1]
    assert [argument.args[0] for argument in arguments] == ["cell", "preset", "set"]
    assert arguments[0].choices == list(CELLS)


@pytest.mark.parametrize("cell", CELLS)
def test_the_nodes_are_those_of_the_graph_file(launch_file: ModuleType, cell: str) -> None:
    nodes = launch_file.start_nodes({"cell": cell, "preset": "", "set": "sim.real_time_factor=0.5"})
    entries = load_graph(cell).nodes
    assert [(node.package, node.executable, node.name) for node in nodes] == [
        (entry.package, entry.executable, entry.name) for entry in entries
    ]
    sim = next(node for node in nodes if node.name == "sim")
    assert sim.parameters[1]["real_time_factor"] == 0.5
