"""What a run of the blocks cell is made of, from the nodes' own configuration."""

from __future__ import annotations

from block_fsm.executor_config import ExecutorConfig, RequestTimeouts
from pack_core.config import Config, merged, validate_config
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


def lockstep_config(price: str | None = None) -> BlocksLockstepConfig:
    """Read `config/nodes/blocks`.

    Args:
        price: what the beam planner's plans are to have least of, instead of what the file says.

    Raises:
        ConfigError: a value is not allowed.
    """
    patience = load_parameters("blocks/fsm", PatienceParameters).patience
    motion = load_parameters("blocks/motion", MotionParameters)
    return BlocksLockstepConfig(
        period=motion.period, motion=motion.parameters, exposure_delay=patience.exposure_delay,
        picture_timeout=patience.picture, jaw_timeout=patience.jaw,
        shadows=load_parameters("blocks/sim", BlocksCameraParameters).shadows,
        simulator=load_parameters("blocks/sim", BlocksSimulatorConfig),
        vision=load_parameters("blocks/tags", TagVisionConfig),
        planner=_planners(price),
        executor=load_parameters("blocks/fsm", ExecutorConfig),
    )  # fmt: skip


def _planners(price: str | None) -> RearrangementConfig:
    planners = load_parameters("blocks/rearrangement", RearrangementConfig)
    if price is None:
        return planners
    values = merged(planners.model_dump(), {"beam": {"price": price}})
    return validate_config(RearrangementConfig, values, "price of the blocks planner")
