"""Lockstep runs of the blocks cell are made of what the nodes are given."""

from pathlib import Path

import pytest
import yaml
from pydantic import BaseModel

from block_fsm.block_fsm_node import BlockFsmNodeConfig
from block_fsm.executor_config import ExecutorConfig
from pack_core.config import validate_config
from pack_core.errors import ConfigError
from pack_lockstep import node_parameters
from pack_lockstep.blocks.settings import lockstep_config
from pack_lockstep.node_parameters import load_parameters, parameters_of
from pack_motion.motion_node import MotionNodeConfig
from pack_perception.tags.tag_vision import TagVisionConfig
from pack_planner.rearrangement.methods import PlanningConfig
from pack_sim.blocks.blocks_sim_node import BlocksSimNodeConfig
from pack_sim.blocks.simulator import BlocksSimulatorConfig

NODES = {
    "fsm": BlockFsmNodeConfig, "motion": MotionNodeConfig, "rearrangement": PlanningConfig,
    "sim": BlocksSimNodeConfig, "tags": TagVisionConfig,
}  # fmt: skip


@pytest.mark.parametrize(("node", "cls"), NODES.items())
def test_every_key_of_a_node_s_file_is_one_of_its_parameters(node: str, cls: type[BaseModel]) -> None:
    parameters, source = parameters_of(f"blocks/{node}")
    assert validate_config(cls, parameters, source).model_fields_set == set(parameters)


def test_lockstep_takes_the_nodes_files() -> None:
    config = lockstep_config()
    assert config.executor == load_parameters("blocks/fsm", ExecutorConfig)
    assert config.simulator == load_parameters("blocks/sim", BlocksSimulatorConfig)
    assert config.vision == load_parameters("blocks/tags", TagVisionConfig)
    assert config.motion == parameters_of("blocks/motion")[0]["parameters"]


@pytest.mark.parametrize(
    ("node", "changes", "seen"),
    [
        ("fsm", {"hover": 0.2}, lambda c: c.executor.hover == 0.2),
        ("fsm", {"patience": {"exposure_delay": 0.3}}, lambda c: c.patience.exposure_delay == 0.3),
        ("tags", {"max_residual": 0.004}, lambda c: c.vision.max_residual == 0.004),
        ("sim", {"shadows": True}, lambda c: c.shadows),
        ("motion", {"period": 0.008}, lambda c: c.period == 0.008),
        ("rearrangement", {"pirs": {"samples": 7}}, lambda c: c.planner.pirs.samples == 7),
    ],
)
def test_a_value_changed_in_a_node_s_file_reaches_the_lockstep_run(
    monkeypatch, tmp_path, node: str, changes: dict, seen
) -> None:
    def changed(*parts: str) -> Path:
        path = original(*parts)
        if path.name != f"{node}.yaml":
            return path
        parameters = yaml.safe_load(path.read_text())[node]["ros__parameters"]
        (tmp_path / path.name).write_text(
            yaml.safe_dump({node: {"ros__parameters": {**parameters, **changes}}})
        )
        return tmp_path / path.name

    original = node_parameters.config_path
    monkeypatch.setattr(node_parameters, "config_path", changed)
    assert seen(lockstep_config())


def test_a_value_that_is_not_allowed_is_named_with_its_file(monkeypatch, tmp_path) -> None:
    file = tmp_path / "fsm.yaml"
    file.write_text("fsm: {ros__parameters: {hover: -1.0}}")
    original = node_parameters.config_path
    monkeypatch.setattr(
        node_parameters, "config_path", lambda *parts: file if "fsm" in parts[-1] else original(*parts)
    )
    with pytest.raises(ConfigError, match=r"fsm\.yaml: key 'hover' is -1\.0"):
        lockstep_config()


def test_parameters_of_planners_are_changed_by_dotted_name() -> None:
    planner = lockstep_config({"pirs": {"costs.collision": "8", "clear_to_goal": "true"}}).planner
    assert (planner.pirs.costs.collision, planner.pirs.clear_to_goal) == (8.0, True)
    assert planner.beam == lockstep_config().planner.beam


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"pirs": {"patient": "2"}}, "patient"),
        ({"magic": {"depth": "2"}}, "magic"),
        ({"pirs": {"depth": "0"}}, "depth"),
    ],
)
def test_a_planner_parameter_that_is_not_allowed_is_named(changes: dict, part: str) -> None:
    with pytest.raises(ConfigError, match=part):
        lockstep_config(changes)
