"""Parameters of spline Gauss-Newton by rollouts."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from pack_core.config import Config


class SgnConfig(Config):
    """Parameters of the optimizer `sgn`; a twist is linear [m/s], then angular [rad/s]."""

    timestep: PositiveFloat = Field(default=0.02, description="time step of the model [s]")
    horizon: PositiveInt = Field(default=30, description="length of the horizon, in steps")
    knots: PositiveInt = Field(default=3, description="knots of the twist spline")
    step_linear: PositiveFloat = Field(default=0.05, description="step of the finite differences [m/s]")
    step_angular: PositiveFloat = Field(default=0.25, description="step of the finite differences [rad/s]")
    explorers: NonNegativeInt = Field(
        default=0, description="random splines in each iteration, where perturbations alone get stuck"
    )
    spread_linear: PositiveFloat = Field(default=0.12, description="standard deviation of explorers [m/s]")
    spread_angular: PositiveFloat = Field(default=0.5, description="standard deviation of explorers [rad/s]")
    dampings: tuple[PositiveFloat, ...] = Field(
        default=(0.01, 0.1, 1.0),
        description="dampings of the Gauss-Newton steps, one rollout each",
    )
    speed_linear: PositiveFloat = Field(default=0.4, description="largest linear twist [m/s]")
    speed_down: PositiveFloat = Field(default=0.4, description="largest downward twist [m/s]")
    speed_landing: PositiveFloat = Field(
        default=0.07, description="largest downward twist where the object may land on another [m/s]"
    )
    speed_angular: PositiveFloat = Field(default=1.5, description="largest angular twist [rad/s]")
    effort: NonNegativeFloat = Field(default=0.02, description="weight of the squared knots in the cost")
    late: PositiveFloat = Field(
        default=0.05,
        description="an iteration that begins so long after the last one perturbs the first knot and one of "
        "the others, in turn, so that a slow processor keeps up [s]",
    )
    leash: PositiveFloat = Field(
        default=0.04, description="lead limit: how far the reference may be ahead of the arm [m]"
    )
