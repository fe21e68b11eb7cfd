"""How a planner's time goes by, on a clock that is handed in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pack_core.blocks.plan import PlanStatistics

Clock = Callable[[], float]


@dataclass
class PlanningProgress:
    """Time since the call, and what was found when.

    Attributes:
        clock: seconds from anywhere.
        budget_s: time for planning [s].
    """

    clock: Clock
    budget_s: float
    setup_s: float = 0.0
    first_s: float = np.nan
    first_actions: int = 0
    expanded: int = 0
    started: float = field(init=False)

    def __post_init__(self) -> None:
        self.started = self.clock()

    def elapsed(self) -> float:
        """Time since the call of the planner [s]."""
        return self.clock() - self.started

    def is_over(self) -> bool:
        """Whether the planner's time is spent."""
        return self.elapsed() >= self.budget_s

    def found(self, actions: int) -> None:
        """Note a plan; only the first is of interest."""
        if np.isnan(self.first_s):
            self.first_s, self.first_actions = self.elapsed(), actions

    def count(self, expanded: int) -> None:
        """Note states expanded or paths planned."""
        self.expanded += expanded

    def statistics(self) -> PlanStatistics:
        """What a plan tells about how it came about."""
        return PlanStatistics(self.setup_s, self.first_s, self.first_actions, self.elapsed(), self.expanded)
