"""The nodes' parameter files as configuration of the cores."""

import itertools

import pytest

from pack_core.errors import ConfigError
from pack_lockstep import node_parameters
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.packing.lockstep_config import lockstep_config
from pack_mpc.session import SessionConfig
from pack_sim.packing.simulator import SimulatorConfig


def test_lockstep_runs_with_what_the_nodes_are_given() -> None:
    config = lockstep_config()
    assert config.simulator == load_parameters("packing/sim", SimulatorConfig)
    assert config.session.weights == "tuned"


def write(tmp_path, monkeypatch, text: str) -> None:
    (tmp_path / "mpc.yaml").write_text(text)
    monkeypatch.setattr(node_parameters, "config_path", lambda _, name: tmp_path / name.rpartition("/")[2])


def test_keys_of_the_node_alone_are_passed_over(tmp_path, monkeypatch) -> None:
    write(tmp_path, monkeypatch, "mpc: {ros__parameters: {weights: table_1, watched: [sim]}}")
    assert load_parameters("packing/mpc", SessionConfig).weights == "table_1"


def test_a_dotted_key_is_one_of_a_section_as_it_is_for_a_node(tmp_path, monkeypatch) -> None:
    text = "task.stages.stall_time: 0.7"
    for keys in itertools.permutations([text, "controller: {threads: 3}", "controller.optimizer: ilqr"]):
        write(tmp_path, monkeypatch, f"mpc: {{ros__parameters: {{{', '.join(keys)}}}}}")
        check_sections()


def check_sections() -> None:
    config = load_parameters("packing/mpc", SessionConfig)
    assert (config.controller.optimizer, config.controller.threads) == ("ilqr", 3)
    assert config.task.stages.stall_time == 0.7


@pytest.mark.parametrize("keys", ["task: 1, task.timeout: 2", "task.timeout: 2, task: 1"])
def test_a_name_for_a_value_and_a_section_is_refused(tmp_path, monkeypatch, keys: str) -> None:
    write(tmp_path, monkeypatch, f"mpc: {{ros__parameters: {{{keys}}}}}")
    with pytest.raises(ConfigError, match="both for a value and for a section"):
        load_parameters("packing/mpc", SessionConfig)


@pytest.mark.parametrize("text", ["[]", "mpc: {}", "planner: {ros__parameters: {}}"])
def test_a_file_of_another_form_is_refused(tmp_path, monkeypatch, text: str) -> None:
    write(tmp_path, monkeypatch, text)
    with pytest.raises(ConfigError, match="expected `mpc: ros__parameters:`"):
        load_parameters("packing/mpc", SessionConfig)


def test_a_missing_file_is_named(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(node_parameters, "config_path", lambda _, name: tmp_path / name.rpartition("/")[2])
    with pytest.raises(ConfigError, match=r"mpc\.yaml: no such file"):
        load_parameters("packing/mpc", SessionConfig)
