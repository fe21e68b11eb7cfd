from pathlib import Path

import pytest

from pack_bringup.graph.graph import Graph, NodeEntry, load_graph, parse_overrides
from pack_bringup.graph.launch import launch_parameters
from pack_core.config import parse_config
from pack_core.errors import ConfigError, PackError
from pack_core.paths import config_path


def test_packing_graph_lists_its_nodes_in_flow_order() -> None:
    names = [node.name for node in load_graph("packing").nodes]
    assert names == ["sim", "perception", "planner", "mpc", "recorder"]


def test_the_simulator_alone_runs_on_the_wall_clock() -> None:
    on_wall_clock = [node.name for node in load_graph("packing").nodes if not node.use_sim_time]
    assert on_wall_clock == ["sim"]


def test_an_unknown_cell_is_answered_with_the_known_ones() -> None:
    with pytest.raises(ConfigError, match=r"no cell 'juggling'.*packing"):
        load_graph("juggling")


def test_an_unknown_key_is_refused_by_name() -> None:
    with pytest.raises(ConfigError, match=r"'nodes\.0\.colour' is not known"):
        parse_config(
            Graph, "nodes: [{name: a, package: b, executable: c, parameters: d, colour: red}]", "g.yaml"
        )


def test_a_repeated_node_name_is_refused_by_name() -> None:
    entry = "{name: sim, package: b, executable: c, parameters: d}"
    with pytest.raises(ConfigError, match="repeated: sim"):
        parse_config(Graph, f"nodes: [{entry}, {entry}]", "g.yaml")


def test_only_keeps_the_flow_order() -> None:
    names = [node.name for node in load_graph("packing").only(["mpc", "sim"]).nodes]
    assert names == ["sim", "mpc"]


def test_only_refuses_an_unknown_node_and_lists_the_known() -> None:
    with pytest.raises(PackError, match="no node 'camera'; it has: sim, perception, planner, mpc, recorder"):
        load_graph("packing").only(["camera"])


def test_overrides_of_an_unknown_node_are_refused() -> None:
    with pytest.raises(PackError, match="no node 'camera'"):
        load_graph("packing").commands({"camera": {"rate": "3"}})


def test_an_override_comes_after_the_parameter_file() -> None:
    command = load_graph("packing").nodes[0].command({"seed": "3"})
    assert command.index("seed:=3") > command.index("--params-file")
    assert command[-2:] == ["-p", "seed:=3"]
    assert "use_sim_time:=false" in command


def test_a_missing_parameter_file_is_named() -> None:
    node = NodeEntry(name="sim", package="pack_sim", executable="sim_node", parameters="nodes/none.yaml")
    with pytest.raises(ConfigError, match=r"'sim': no parameter file .*none\.yaml"):
        node.command()


def test_settings_are_split_at_the_first_dot_and_the_first_equals_sign() -> None:
    assert parse_overrides(["mpc.weights.up=1.0", "sim.note=a=b", "sim.seed=3"]) == {
        "mpc": {"weights.up": "1.0"},
        "sim": {"note": "a=b", "seed": "3"},
    }


@pytest.mark.parametrize("setting", ["sim", "sim.seed", "seed=3", ".seed=3", "sim.=3"])
def test_a_malformed_setting_is_answered_with_the_form(setting: str) -> None:
    with pytest.raises(PackError, match=r"write node\.parameter=value"):
        parse_overrides([setting])


def test_parameter_files_lie_below_config() -> None:
    for node in load_graph("packing").nodes:
        assert node.parameters_path.is_relative_to(Path(config_path()))


def test_what_is_launched_has_the_presets_values_and_those_given_over_them() -> None:
    given = launch_parameters("packing", "hardware", ["mpc.task.force_stop=30.0", "sim.seed=3"])
    assert list(given) == [node.name for node in load_graph("packing").nodes]
    assert given["mpc"]["task.force_stop"] == 30.0
    assert given["sim"]["seed"] == 3
    assert given["sim"]["mismatch.friction"]
    assert given["recorder"]["preset"] == "hardware"
    assert not given["sim"]["use_sim_time"]


def test_a_setting_of_a_node_that_there_is_not_is_refused_at_launch() -> None:
    with pytest.raises(PackError, match=r"no node 'juggler'; it has: .*recorder"):
        launch_parameters("blocks", "", ["juggler.balls=3"])


def test_a_calibration_that_the_launch_file_is_given_goes_to_the_nodes_that_know_the_cell() -> None:
    file = config_path("calibrations", "none.yaml")
    with pytest.raises(PackError, match=r"none\.yaml"):
        launch_parameters("palletizing", "real", (), str(file))
    with pytest.raises(ConfigError, match=r"cell 'blocks' takes no calibration; .*: packing, palletizing"):
        launch_parameters("blocks", "", (), str(file))
