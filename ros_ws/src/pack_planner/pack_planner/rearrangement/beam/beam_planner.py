"""Beam search, ever wider, until the time is over or the lower bound is met."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveInt

from pack_core.blocks.plan import Action
from pack_core.config import Config
from pack_planner.rearrangement.beam.pushing import Ints
from pack_planner.rearrangement.beam.reconstruction import to_actions
from pack_planner.rearrangement.beam.search import Beam, root_state, run_round
from pack_planner.rearrangement.beam.spots import GOAL, POOL, buffer_pool
from pack_planner.rearrangement.beam.tables import Tables, build_tables
from pack_planner.rearrangement.freed import with_freed_blocks
from pack_planner.rearrangement.lower_bound import sharper_bound
from pack_planner.rearrangement.progress import Progress
from pack_planner.rearrangement.task import Task

LONGEST = 3
"""Actions a block that a plan may have, and a few more."""
LATE = 2
"""Times as many buffer poses in rounds after the widest."""
PATIENCE = 3
"""Rounds without a plan before the search opens up."""


class BeamConfig(Config):
    """Parameters of the beam search."""

    pool: PositiveInt = Field(256, description="buffer poses")
    widths: tuple[PositiveInt, ...] = Field(
        (4, 16, 64, 256, 1024), description="states kept of a layer, round by round; then the last again"
    )
    breadth: PositiveInt = Field(4, description="buffer poses tried for a block in a state")
    noise: NonNegativeFloat = Field(0.3, description="of the ranks of states [actions]")
    rounds: PositiveInt = Field(200, description="at most")


def plan_by_beam(
    task: Task, lower_bound: int, progress: Progress, rng: np.random.Generator, config: BeamConfig
) -> tuple[list[Action] | None, int]:
    """The shortest plan found, None where there is none in time, and the best lower bound.

    Every round demands a plan shorter than the best so far, with a wider beam. Rounds after the widest, and
    those after a few without any plan, draw new buffer poses, the former more of them, and the latter also
    let blocks make way that are in nobody's.
    """
    given, task = task, with_freed_blocks(task)
    best: list[Action] | None = None
    longest = LONGEST * (task.n + 3)
    for number in range(config.rounds):
        is_lost = best is None and number >= PATIENCE
        is_late = number >= len(config.widths)
        if number == 0 or is_lost or is_late:
            size = config.pool * (LATE if is_late else 1)
            tables = build_tables(task, buffer_pool(task, size, rng, is_over_goals=is_late))
        width = config.widths[min(number, len(config.widths) - 1)]
        beam = Beam(width, longest, config.breadth, is_lost and number % 2 == 0, config.noise)
        root = root_state(tables, _spots(task))
        outcome = run_round(root, tables, _order(tables, rng), beam, progress.is_over, rng)
        progress.count(outcome.expanded)
        if outcome.moves is not None:
            is_first = best is None
            best = to_actions(task, tables, outcome.moves)
            longest = len(best) - 1
            progress.found(len(best))
            if is_first and longest >= lower_bound:
                lower_bound = sharper_bound(given, lower_bound)
        if longest < lower_bound or progress.is_over():
            break
    return best, lower_bound


def _spots(task: Task) -> npt.NDArray[np.int16]:
    return (np.arange(task.n) + GOAL * task.is_home).astype(np.int16)


def _order(tables: Tables, rng: np.random.Generator) -> Ints:
    """Buffer poses in the order in which every block looks at them, with some chance `(n, P)`.

    Its own push line first, then where it is least in the way of the goals.
    """
    crowds = np.bitwise_count(tables.crowds[POOL:]).astype(float)
    cost = 1.5 * (tables.push_of[:, POOL:] < 0) + crowds[:, 0] + 0.3 * crowds[:, 1]
    order = np.argsort(cost + rng.uniform(0.0, 1.5, cost.shape), axis=1)
    return (POOL + order).astype(np.int32)
