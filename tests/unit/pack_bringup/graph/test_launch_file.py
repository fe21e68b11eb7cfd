"""The launch file, with stand-ins for launch and launch_ros, which the wheels do not bring."""

import importlib.util
import sys
from types import ModuleType, SimpleNamespace

import pytest
import yaml

from pack_bringup.graph.graph import load_graph
from pack_core.cells import CELLS
from pack_core.errors import ConfigError
from pack_core.paths import config_path, project_root

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
        "launch.actions": (
            "DeclareLaunchArgument",
            "ExecuteProcess",
            "OpaqueFunction",
            "SetEnvironmentVariable",
        ),
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


def start(launch_file: ModuleType, **given: str) -> list[Recorded]:
    """What is started with these arguments; those left out are as the file declares them."""
    declared = {a.args[0]: a for a in launch_file.generate_launch_description().args[0][:-1]}
    defaults = {name: getattr(a, "default_value", None) for name, a in declared.items()}
    assert given.keys() <= defaults.keys()
    actions: list[Recorded] = launch_file.start_cell(defaults | given)
    return actions


def parameters_of(actions: list[Recorded], name: str) -> dict[str, object]:
    (node,) = (action for action in actions if getattr(action, "name", "") == name)
    given: dict[str, object] = node.parameters[1]
    return given


def test_every_registered_cell_can_be_chosen(launch_file: ModuleType) -> None:
    first, *others = launch_file.generate_launch_description().args[0][:-1]
    assert first.choices == list(CELLS)
    assert {argument.args[0] for argument in others} == {
        "seed", "scene", "order", "preset", "calibration", "domain", "live", "record", "keystore", "set",
        "namespace",
    }  # fmt: skip
    assert all(argument.description for argument in others)


@pytest.mark.parametrize("cell", CELLS)
def test_the_nodes_are_those_of_the_graph_file(launch_file: ModuleType, cell: str) -> None:
    actions = start(launch_file, cell=cell, set="sim.real_time_factor=0.5")
    assert [(node.package, node.executable, node.name) for node in actions] == [
        (entry.package, entry.executable, entry.name) for entry in load_graph(cell).nodes
    ]
    assert parameters_of(actions, "sim")["real_time_factor"] == 0.5


def test_arguments_become_parameters_and_set_goes_over_them(launch_file: ModuleType) -> None:
    actions = start(launch_file, cell="packing", seed="4", scene="my.yaml", record="never", set="sim.seed=5")
    sim, recorder = parameters_of(actions, "sim"), parameters_of(actions, "recorder")
    assert (sim["seed"], sim["scene"], recorder["record"]) == (5, "my.yaml", "never")
    assert parameters_of(start(launch_file, cell="blocks", scene="p.yaml"), "sim")["problem"] == "p.yaml"


def test_the_domain_comes_first_and_page_and_order_are_processes_beside_the_nodes(
    launch_file: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    actions = start(launch_file, cell="palletizing", domain="7", live="true", order="order_03.json")
    assert actions[0].args == ("ROS_DOMAIN_ID", "7")
    page, order = actions[-2:]
    assert any("live_node" in part for part in page.cmd)
    assert order.cmd == ["pack", "goal", "palletizing", "--order", "order_03.json"]


def test_in_a_namespace_nodes_get_what_their_files_give_and_page_and_order_are_of_that_cell(
    launch_file: ModuleType,
) -> None:
    actions = start(
        launch_file, cell="palletizing", namespace="left", live="true", order="a.json", set="sim.seed=5"
    )
    nodes = [action for action in actions if hasattr(action, "namespace")]
    assert {node.namespace for node in nodes} == {"/left"}
    sim = next(node for node in nodes if node.name == "sim")
    # A file's key is the name of a node in no namespace, so its values are given instead.
    file = yaml.safe_load(config_path("nodes", "palletizing", "sim.yaml").read_text())
    assert sim.parameters[0] == file["sim"]["ros__parameters"]
    assert sim.parameters[1]["seed"] == 5
    page, order = actions[-2:]
    assert "__ns:=/left" in page.cmd
    assert order.cmd[-2:] == ["--namespace", "/left"]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"cell": "blocks", "seed": "1"}, "cells that have: packing, palletizing"),
        ({"cell": "palletizing", "scene": "a.yaml"}, "takes order:="),
        ({"cell": "packing", "order": "a.json"}, "only the cell 'palletizing'"),
        ({"cell": "packing", "record": "sometimes"}, "allowed: goals, always, never"),
        ({"cell": "packing", "live": "maybe"}, "allowed: true, false"),
    ],
)
def test_an_argument_that_a_cell_does_not_have_is_refused_with_those_that_do(
    launch_file: ModuleType, given: dict[str, str], said: str
) -> None:
    with pytest.raises(ConfigError, match=said):
        start(launch_file, **given)
