"""What a run of the blocks cell is made of, from the nodes' own configuration."""

from __future__ import annotations

import re
from pathlib import Path

from block_fsm.executor_config import ErrandConfig, ExecutorConfig
from pack_core.config import Config
from pack_core.paths import bags_path
from pack_lockstep.blocks.lockstep import BlocksLockstepConfig
from pack_lockstep.node_parameters import load_parameters
from pack_perception.tags.tag_vision import TagVisionConfig
from pack_planner.rearrangement.planner import RearrangementConfig
from pack_sim.blocks.simulator import BlocksSimulatorConfig


class PatienceParameters(Config):
    """The part of the executor's parameters that says how long things take."""

    patience: ErrandConfig = ErrandConfig()


class CameraParameters(Config):
    """The part of the simulator's parameters that is the camera's."""

    shadows: bool = False


class MotionParameters(Config):
    """The part of the motion controller's parameters that decides how the arm moves."""

    parameters: str
    period: float


def lockstep_config() -> BlocksLockstepConfig:
    """Read `config/nodes/blocks`; raises ConfigError where a value is not allowed."""
    patience = load_parameters("blocks/fsm", PatienceParameters).patience
    motion = load_parameters("blocks/motion", MotionParameters)
    return BlocksLockstepConfig(
        period=motion.period, motion=motion.parameters, exposure_delay=patience.exposure_delay,
        jaw_timeout=patience.jaw, shadows=load_parameters("blocks/sim", CameraParameters).shadows,
        simulator=load_parameters("blocks/sim", BlocksSimulatorConfig),
        vision=load_parameters("blocks/tags", TagVisionConfig),
        planner=load_parameters("blocks/rearrangement", RearrangementConfig),
        executor=load_parameters("blocks/fsm", ExecutorConfig),
    )  # fmt: skip


def default_output(what: str, budget: float, *, with_execution: bool) -> Path:
    """Where a benchmark's results are kept when no file is given."""
    how = "executed" if with_execution else "planned"
    name = re.sub(r"[^A-Za-z0-9.]+", "_", what)
    return bags_path() / "benchmarks" / f"blocks_{how}_{name}_{budget:g}s.jsonl"
