"""The rearrangement planner, timed by its work rather than by the clock."""

from __future__ import annotations

from pydantic import Field, PositiveFloat

from pack_core.blocks.plan import Plan
from pack_core.blocks.problem import Problem
from pack_core.config import Config
from pack_planner.rearrangement.methods import DEFAULT_METHOD, MethodName, RearrangementConfig
from pack_planner.rearrangement.planning import plan


class CountingClock:
    """A clock that goes on by a step whenever it is read, so that a run repeats on any machine."""

    def __init__(self, step: float) -> None:
        self._step, self._time = step, 0.0

    def __call__(self) -> float:
        """The time [s], a step later at every reading."""
        self._time += self._step
        return self._time


class CountedPlannerConfig(Config):
    """Parameters of planning in lockstep."""

    method: MethodName = DEFAULT_METHOD
    budget: PositiveFloat = Field(default=0.5, description="of a plan, on the counting clock [s]")
    step: PositiveFloat = Field(default=0.005, description="by which that clock goes on [s]")
    seed: int = Field(default=0, ge=0, description="of what the planner draws at random")


class CountedPlanner:
    """Plans with a budget of work.

    Args:
        config: method and budget.
        methods: parameters of the methods.
    """

    def __init__(self, config: CountedPlannerConfig, methods: RearrangementConfig) -> None:
        self._config, self._methods = config, methods

    def __call__(self, problem: Problem) -> Plan:
        """A plan for a problem."""
        config = self._config
        return plan(
            problem, method=config.method, budget_s=config.budget, seed=config.seed,
            config=self._methods, clock=CountingClock(config.step),
        )  # fmt: skip
