"""What every rearrangement planner offers and is given: one class, whose fields are its parameters.

It plans a `SnappedProblem`, looks at a `PlanningTimer` for when to end, and returns what it `Found`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple, Self

import numpy as np

from pack_core.blocks.plan import Action, PlanStatistics
from pack_core.config import Config
from pack_planner.rearrangement.snapped_problem import SnappedProblem

Clock = Callable[[], float]
Enough = Callable[[Sequence[Action]], bool]
"""Whether a plan that was found ends the planning."""


@dataclass
class PlanningTimer:
    """Time since the call, and what was found when.

    Attributes:
        clock: seconds from anywhere.
        budget_s: time for planning [s].
        is_enough: whether a plan that was found ends the planning before its time is over.
    """

    clock: Clock
    budget_s: float
    is_enough: Enough
    setup_s: float = 0.0
    first_s: float = np.nan
    first_actions: int = 0
    expanded: int = 0
    started: float = field(init=False)
    has_enough: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self.started = self.clock()

    def elapsed(self) -> float:
        """Time since the call of the planner [s]."""
        return self.clock() - self.started

    def is_over(self) -> bool:
        """Whether the planner's time is spent, or a plan was found that is enough."""
        return self.has_enough or self.elapsed() >= self.budget_s

    def found(self, actions: Sequence[Action]) -> None:
        """Note a plan; of the time only that of the first is of interest."""
        if np.isnan(self.first_s):
            self.first_s, self.first_actions = self.elapsed(), len(actions)
        self.has_enough = self.is_enough(actions)

    def count(self, expanded: int) -> None:
        """Note states expanded or paths planned."""
        self.expanded += expanded

    def statistics(self) -> PlanStatistics:
        """What a plan tells about how it came about."""
        return PlanStatistics(self.setup_s, self.first_s, self.first_actions, self.elapsed(), self.expanded)


class Found(NamedTuple):
    """What a planner found.

    Attributes:
        actions: the plan, in order; None where none was found in time.
        lower_bound: every plan has at least so many actions.
    """

    actions: list[Action] | None
    lower_bound: int


class RearrangementPlanner(Config, ABC):
    """A way to plan rearrangements.

    A subclass states its parameters as fields and plans in `plan`. It becomes a method by one line in
    `METHODS` (`methods.py`), with the name that nodes, lockstep and commands take.

    Attributes:
        most_blocks: problems with more blocks are refused before the planner is asked.
        avoids_obstacles: whether it plans around what stands on the table and is not to be moved; if not,
            problems with obstacles are refused before it is asked.
    """

    most_blocks: ClassVar[int] = 64
    avoids_obstacles: ClassVar[bool] = False

    @abstractmethod
    def plan(
        self, snapped: SnappedProblem, lower_bound: int, timer: PlanningTimer, rng: np.random.Generator
    ) -> Found:
        """Plan a problem in which some block is away from its goal, and which is not proven impossible.

        It ends soon after `timer.is_over()`, reports every plan that may be its answer to `timer.found` and
        uses nothing like what is in `snapped.problem.refused`.

        Args:
            snapped: blocks, goals and what counts as being there.
            lower_bound: every plan has at least so many actions; a planner may know better.
            timer: time, and what is counted.
            rng: the only source of chance, so that a seed gives the same plan again.
        """

    def for_warm_up(self) -> Self:
        """The same planner with parameters by which it runs all of its code once and ends soon."""
        return self
