"""Weights of the residuals, per stage: `config/weights/*.yaml` (Table I).

A file has a weight for each residual by the name of its class in `residuals.py`, and a norm for each
that is not to be squared (`norms.py`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config, load_config
from pack_core.errors import ConfigError
from pack_core.paths import config_path
from pack_core.register import with_fields
from pack_mpc.cost.norms import AnyNorm, Linear
from pack_mpc.cost.residuals import RESIDUALS, ResidualOptions
from pack_mpc.target import Stage


def _known(name: str) -> str:
    """The name of a residual; anything else is refused with those that exist."""
    if name not in _BY_NAME:
        raise ValueError(", ".join(_BY_NAME))
    return name


def _complete(weights: Mapping[str, Weight]) -> Mapping[str, Weight]:
    """The weights of all residuals: those given, and the class's default for each that is not."""
    for name, weight in weights.items():
        rows = getattr(_BY_NAME[name], "rows", None)
        if isinstance(weight, tuple) and len(weight) != rows:
            allowed = "one number" + (f", or {rows} numbers" if rows else "")
            raise ValueError(f"{allowed} for '{name}'; {len(weight)} were given")
    return {name: weights.get(name, term.default_weight) for name, term in _BY_NAME.items()}


_BY_NAME = {term.name: term for term in RESIDUALS}

Weight = NonNegativeFloat | tuple[NonNegativeFloat, ...]
"""One number for all rows of a residual, or one number a row."""

Weights = Annotated[Mapping[Annotated[str, AfterValidator(_known)], Weight], AfterValidator(_complete)]
"""The weight of every residual by its name. One that a file leaves out has its class's default weight."""


def _fitting(norms: Mapping[str, AnyNorm]) -> Mapping[str, AnyNorm]:
    """The norms, if each can take the values of its residual."""
    for name, norm in norms.items():
        if isinstance(norm, Linear) and not _BY_NAME[name].is_never_negative:
            fitting = ", ".join(term.name for term in RESIDUALS if term.is_never_negative)
            raise ValueError(f"norm linear for {fitting} only; '{name}' can be negative: give it smooth_abs")
    return norms


Norms = Annotated[Mapping[Annotated[str, AfterValidator(_known)], AnyNorm], AfterValidator(_fitting)]
"""Norms of residuals by their names."""


Factor = Annotated[float, Field(ge=0.0, le=10.0)]


@with_fields(
    {
        term.name: (Factor, Field(default=1.0, description=f"on the weight of {term.measures}"))
        for term in RESIDUALS
    }
)
class WeightFactors(Config):
    """A factor on each residual's weight, in all stages; 1 leaves it as the set of weights has it.

    They are for trying other weights without another file of them.
    """


class StageWeights(Config):
    """Weights of a stage: `running` for the steps before the last, `terminal` for the last."""

    running: Weights
    terminal: Weights

    def times(self, factors: Mapping[str, Weight]) -> StageWeights:
        """The same weights with those of the residuals named in `factors` multiplied by them."""
        running, terminal = (_times(weights, factors) for weights in (self.running, self.terminal))
        return StageWeights(running=running, terminal=terminal)


def _times(weights: Weights, factors: Mapping[str, Weight]) -> dict[str, Weight]:
    changed = {name: _product(factor, weights[name]) for name, factor in factors.items()}
    return {**weights, **changed}


def _product(a: Weight, b: Weight) -> Weight:
    product: Weight = np.multiply(a, b).tolist()
    return product


class WeightSet(ResidualOptions):
    """A named set of weights.

    Attributes:
        pre_pack: weights of the stage PRE-PACK; the other stages likewise.
        force_relief: factor on the force's weight for each attempt that failed: what does not yield to a
            light push may yield to a firm one.
        precision: factor on the weights of the horizontal position along an entry that was rehearsed.
        obstacle_decay: time Z of Eq. 3 within which the obstacle's weight falls to zero [s].
        torque: weight of squared torque.
        lean: tilt of the held object over its obstacles at the entry [rad].
    """

    norms: Norms = Field(default_factory=dict)
    pre_pack: StageWeights
    insert: StageWeights
    fine_tune: StageWeights
    force_relief: float = Field(default=1.0, gt=0, le=1)
    precision: PositiveFloat = 1.0
    obstacle_decay: PositiveFloat
    torque: PositiveFloat
    lean: NonNegativeFloat

    def of(self, stage: Stage) -> StageWeights:
        """The weights of a stage as the file has them; LOOK, a free motion as well, has those of PRE-PACK."""
        own = Stage.PRE_PACK if stage is Stage.LOOK else stage
        weights: StageWeights = getattr(self, own.value)
        return weights

    def times(self, factors: WeightFactors) -> WeightSet:
        """The same set with the weights of every stage multiplied by factors."""
        changed = {name: factor for name, factor in factors.model_dump().items() if factor != 1.0}
        stages = (Stage.PRE_PACK, Stage.INSERT, Stage.FINE_TUNE)
        return self.model_copy(update={stage.value: self.of(stage).times(changed) for stage in stages})

    def in_force(
        self, stage: Stage, stage_age: float, *, reliefs: float = 0.0, is_rehearsed: bool = False
    ) -> StageWeights:
        """The weights of a stage as they are at a moment of it.

        Eq. 3 lets the obstacle's weight decay: w_t = max(0, w_0 - t w_0 / Z).

        Args:
            stage: the stage.
            stage_age: time t since the stage began [s].
            reliefs: number of times that the force's weight is relieved; it need not be whole.
            is_rehearsed: whether the target lies on an entry that was rehearsed.
        """
        sideways = self.precision if is_rehearsed else 1.0
        return self.of(stage).times({
            "force": self.force_relief**reliefs,
            "position": (sideways, sideways, 1.0),
            "obstacle": max(0.0, 1.0 - stage_age / self.obstacle_decay),
        })  # fmt: skip


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
