"""What a run of the blocks cell is made of, from the nodes' own configuration."""

from __future__ import annotations

from collections.abc import Mapping

from block_fsm.executor_config import ExecutorConfig, RequestTimeouts
from pack_core.config import Config, merged, validate_config
from pack_core.parameter_fields import nested
from pack_core.text.yaml_text import parse_yaml
from pack_lockstep.blocks.lockstep import BlocksLockstepConfig
from pack_lockstep.node_parameters import load_parameters
from pack_perception.tags.tag_vision import TagVisionConfig
from pack_planner.rearrangement.methods import RearrangementConfig
from pack_sim.blocks.simulator import BlocksSimulatorConfig


class PatienceParameters(Config):
    """The part of the executor's parameters that says how long things take."""

    patience: RequestTimeouts = RequestTimeouts()


class BlocksCameraParameters(Config):
    """The part of the simulator's parameters that is the camera's."""

    shadows: bool = False


class MotionParameters(Config):
    """The part of the motion controller's parameters that decides how the arm moves."""

    parameters: str
    period: float


def lockstep_config(planners: Mapping[str, Mapping[str, str]] | None = None) -> BlocksLockstepConfig:
    """Read `config/nodes/blocks`.

    Args:
        planners: parameters of planners to take instead of the file's: YAML text by dotted name, by planner.

    Raises:
        ConfigError: a value is not allowed.
    """
    patience = load_parameters("blocks/fsm", PatienceParameters).patience
    motion = load_parameters("blocks/motion", MotionParameters)
    return BlocksLockstepConfig(
        period=motion.period, motion=motion.parameters, patience=patience,
        shadows=load_parameters("blocks/sim", BlocksCameraParameters).shadows,
        simulator=load_parameters("blocks/sim", BlocksSimulatorConfig),
        vision=load_parameters("blocks/tags", TagVisionConfig),
        planner=_planners(planners or {}),
        executor=load_parameters("blocks/fsm", ExecutorConfig),
    )  # fmt: skip


def _planners(changes: Mapping[str, Mapping[str, str]]) -> RearrangementConfig:
    planners = load_parameters("blocks/rearrangement", RearrangementConfig)
    if not changes:
        return planners
    source = "parameters of the blocks planners (--set, over config/nodes/blocks/rearrangement.yaml)"
    values = {
        planner: nested({name: parse_yaml(text, source) for name, text in parameters.items()})
        for planner, parameters in changes.items()
    }
    return validate_config(RearrangementConfig, merged(planners.model_dump(), values), source)
