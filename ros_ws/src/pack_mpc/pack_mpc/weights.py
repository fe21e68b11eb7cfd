"""Weights of the residuals, per stage: `config/weights/*.yaml` (Table I)."""

from __future__ import annotations

from enum import Enum
from typing import Annotated, Literal

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config, load_config
from pack_core.errors import ConfigError
from pack_core.paths import config_path


class Stage(Enum):
    """Stages of the task (section III-B2)."""

    PRE_PACK = "pre_pack"
    INSERT = "insert"
    FINE_TUNE = "fine_tune"


class Weights(Config):
    """One weight a residual."""

    position: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat]
    upright: NonNegativeFloat
    yaw: NonNegativeFloat
    force: NonNegativeFloat
    joint_limit: NonNegativeFloat
    joint_velocity: Annotated[tuple[NonNegativeFloat, ...], Field(min_length=7, max_length=7)]
    obstacle: NonNegativeFloat


class StageWeights(Config):
    """Weights of the steps before the last, and of the last."""

    running: Weights
    terminal: Weights

    def scaled(self, force: float, sideways: float) -> StageWeights:
        """The same weights with the force's and the horizontal position's times these."""
        running, terminal = (_scaled(weights, force, sideways) for weights in (self.running, self.terminal))
        return StageWeights(running=running, terminal=terminal)


def _scaled(weights: Weights, force: float, sideways: float) -> Weights:
    x, y, z = weights.position
    return weights.model_copy(
        update={"force": force * weights.force, "position": (sideways * x, sideways * y, z)}
    )


class WeightSet(Config):
    """A named set of weights.

    Attributes:
        upright: how the upright residual is written: as the angle, or as the axis' x and y.
        force_dead_band: force that costs nothing [N].
        force_relief: what is left of the force's weight after each attempt that failed: what does not
            yield to a light push may yield to a firm one.
        precision: factor on the weights of the horizontal position along an entry that was rehearsed.
        obstacle_decay: Z of Eq. 3 as a time [s].
        torque: cost of squared torque.
        lean: tilt of the held object over its obstacles at the entry [rad].
    """

    pre_pack: StageWeights
    insert: StageWeights
    fine_tune: StageWeights
    upright: Literal["angle", "axis"]
    force_dead_band: NonNegativeFloat
    force_relief: float = Field(default=1.0, gt=0, le=1)
    precision: PositiveFloat = 1.0
    obstacle_decay: PositiveFloat
    torque: PositiveFloat
    lean: NonNegativeFloat

    def of(self, stage: Stage) -> StageWeights:
        """The weights of a stage."""
        weights: StageWeights = getattr(self, stage.value)
        return weights


def load_weights(name: str) -> WeightSet:
    """The set `config/weights/<name>.yaml`.

    Raises:
        ConfigError: there is no such set, or it has a key or value that is not allowed.
    """
    path = config_path("weights", f"{name}.yaml")
    if not path.is_file():
        known = sorted(item.stem for item in path.parent.glob("*.yaml"))
        raise ConfigError(f"no weight set '{name}'; allowed: {', '.join(known)} (files in {path.parent})")
    return load_config(WeightSet, path)
