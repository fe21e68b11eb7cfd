"""What every rearrangement planner offers: one class, whose fields are its parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, NamedTuple, Self

import numpy as np

from pack_core.blocks.plan import Action
from pack_core.config import Config
from pack_planner.rearrangement.progress import PlanningProgress
from pack_planner.rearrangement.task import Task


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
    `RearrangementConfig`, whose field names are the names that nodes, lockstep and commands take.

    Attributes:
        most_blocks: problems with more blocks are refused before the planner is asked.
        avoids_obstacles: whether it plans around what stands on the table and is not to be moved; if not,
            problems with obstacles are refused before it is asked.
    """

    most_blocks: ClassVar[int] = 64
    avoids_obstacles: ClassVar[bool] = False

    @abstractmethod
    def plan(
        self, task: Task, lower_bound: int, progress: PlanningProgress, rng: np.random.Generator
    ) -> Found:
        """Plan a task in which some block is away from its goal, and which is not proven impossible.

        It ends soon after `progress.is_over()`, reports its first plan to `progress.found` and uses nothing
        like what is in `task.problem.refused`.

        Args:
            task: blocks, goals and what counts as being there.
            lower_bound: every plan has at least so many actions; a planner may know better.
            progress: time, and what is counted.
            rng: the only source of chance, so that a seed gives the same plan again.
        """

    def for_warm_up(self) -> Self:
        """The same planner with parameters by which it runs all of its code once and ends soon."""
        return self
