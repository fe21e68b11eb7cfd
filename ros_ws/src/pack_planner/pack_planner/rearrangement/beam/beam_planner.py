"""Beam search, ever wider, until the time is over or the lower bound is met."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt, model_validator

from pack_core.blocks.plan import Action, Push
from pack_core.blocks.planar import PlanarPose, turn_between
from pack_core.config import Config
from pack_core.rotations import Array
from pack_planner.rearrangement.beam.search import Beam, root_state, run_round
from pack_planner.rearrangement.beam.spots import GOAL, MAX_BLOCKS, NO_SPOT, POOL, STRAIGHT, Ints, buffer_pool
from pack_planner.rearrangement.beam.states import NO_STAGE, PUSHED, BlockMove
from pack_planner.rearrangement.beam.tables import FREE, PushPrice, Tables, build_tables
from pack_planner.rearrangement.certificates import with_blockers_released
from pack_planner.rearrangement.lower_bound import sharper_bound
from pack_planner.rearrangement.rearrangement_planner import Found, PlanningTimer, RearrangementPlanner
from pack_planner.rearrangement.snapped_problem import SnappedProblem, carried

LONGEST = 3
"""Actions a block that a plan may have, and a few more."""
WORTH = 1e-4
"""A plan must be cheaper than the best before it by this, in pick-and-place actions; below it is rounding."""
LATE = 2
"""Times as many buffer poses in rounds after the widest."""
FRUITLESS_ROUNDS = 3
"""Rounds without a plan before the search opens up."""


class PlanCosts(Config):
    """What the actions of a plan cost with `price: paper`, see PushPrice.

    The terms of Eq. 1 without the one for blocks in collision: what is carried out collides with none.
    """

    pick_place: PositiveFloat = Field(1.0, description="alpha_1")
    push: PositiveFloat = Field(1.5, description="alpha_2, not below alpha_1; a push is less precise")
    push_length: NonNegativeFloat = Field(5.0, description="of a push's length, Section V [1/m]")

    @model_validator(mode="after")
    def _push_costs_more(self) -> PlanCosts:
        if self.push < self.pick_place:
            raise ValueError(f"push is {self.push:g}; allowed: pick_place, {self.pick_place:g}, or more")
        return self

    @property
    def push_price(self) -> PushPrice:
        """What a push costs beyond a pick-and-place action."""
        return PushPrice(self.push / self.pick_place - 1.0, self.push_length / self.pick_place)


class BeamPlanner(RearrangementPlanner):
    """The cheapest plan that a beam search finds in its time; its parameters are those of the search."""

    most_blocks: ClassVar[int] = MAX_BLOCKS
    avoids_obstacles: ClassVar[bool] = True

    price: Literal["actions", "paper"] = Field(
        "actions", description="what a plan is to have least of: actions, or cost as in the paper's Eq. 1"
    )
    costs: PlanCosts = Field(default_factory=PlanCosts, description="of actions, with `price: paper`")

    pool: PositiveInt = Field(256, description="buffer poses")
    widths: tuple[PositiveInt, ...] = Field(
        (4, 16, 64, 256, 1024), description="states kept of a layer, round by round; then the last again"
    )
    breadth: PositiveInt = Field(4, description="buffer poses tried for a block in a state")
    noise: NonNegativeFloat = Field(0.3, description="of the ranks of states [actions]")
    rounds: PositiveInt = Field(200, description="at most")

    @property
    def push_price(self) -> PushPrice:
        """What a push costs beyond a pick-and-place action."""
        return self.costs.push_price if self.price == "paper" else FREE

    def plan(
        self, snapped: SnappedProblem, lower_bound: int, timer: PlanningTimer, rng: np.random.Generator
    ) -> Found:
        """Search round after round until the time is over or the lower bound is met.

        Every round demands a plan cheaper than the best so far, with a wider beam. Rounds after the widest,
        and those after a few without any plan, draw new buffer poses, the former more of them, and the latter
        also let blocks make way that are in nobody's.

        With `price: actions` the cheapest plan is the shortest. With `price: paper` it is the one that costs
        least by Eq. 1; the lower bound counts actions all the same, so that no plan with a push is proven the
        cheapest and the search uses all its time.
        """
        given, snapped = snapped, with_blockers_released(snapped)
        best: list[Action] | None = None
        price = self.push_price
        longest, cheapest = LONGEST * (snapped.n + 3), np.inf
        for number in range(self.rounds):
            is_lost = best is None and number >= FRUITLESS_ROUNDS
            is_late = number >= len(self.widths)
            if number == 0 or is_lost or is_late:
                size = self.pool * (LATE if is_late else 1)
                tables = build_tables(snapped, buffer_pool(snapped, size, rng, is_over_goals=is_late), price)
            width = self.widths[min(number, len(self.widths) - 1)]
            is_anyone = is_lost and number % 2 == 0
            beam = Beam(width, longest, cheapest - WORTH, self.breadth, is_anyone, self.noise)
            root = root_state(tables, _spots(snapped))
            outcome = run_round(root, tables, _order(tables, rng), beam, timer.is_over, rng)
            timer.count(outcome.expanded)
            if outcome.moves is not None:
                is_first = best is None
                best = to_actions(snapped, tables, outcome.moves)
                cheapest = len(best) + sum(price.premium(a.distance) for a in best if isinstance(a, Push))
                longest = int(np.ceil(cheapest)) - 1
                timer.found(best)
                if is_first and longest >= lower_bound:
                    lower_bound = sharper_bound(given, lower_bound)
            if longest < lower_bound or timer.is_over():
                break
        return Found(best, lower_bound)

    def for_warm_up(self) -> Self:
        """One narrow round runs all that is compiled."""
        return self.model_copy(update={"widths": (16,), "rounds": 1})


def _spots(snapped: SnappedProblem) -> npt.NDArray[np.int16]:
    return (np.arange(snapped.n) + GOAL * snapped.is_home).astype(np.int16)


def _order(tables: Tables, rng: np.random.Generator) -> Ints:
    """Buffer poses in the order in which every block looks at them, with some chance `(n, P)`.

    Those for blocks of its shape; NO_SPOT behind them.

    Its own push line first, near its goal where the length of a push has a price, then where it is least in
    the way of the goals.
    """
    crowds = np.bitwise_count(tables.crowds[POOL:]).astype(float)
    is_off_line = tables.push_of[:, POOL:] < 0
    cost = 1.5 * is_off_line + crowds[:, 0] + 0.3 * crowds[:, 1]
    goals = tables.poses[GOAL : GOAL + len(cost), None, :2]
    lengths = np.linalg.norm(goals - tables.poses[POOL:, :2], axis=-1)
    cost += np.where(is_off_line, 0.0, tables.push_price.per_metre * lengths)
    cost += rng.uniform(0.0, 1.5, cost.shape)
    cost[~tables.fits[:, POOL:]] = np.inf
    order = np.argsort(cost, axis=1)
    is_of_shape = np.take_along_axis(tables.fits[:, POOL:], order, axis=1)
    return np.where(is_of_shape, POOL + order, NO_SPOT).astype(np.int32)


def to_actions(snapped: SnappedProblem, tables: Tables, moves: Iterable[BlockMove]) -> list[Action]:
    """Actions of a plan; a block that would be put down where it was picked up is left alone."""
    poses = [PlanarPose(*row) for row in snapped.starts.tolist()]
    spots = [tables.poses[GOAL + i if home else i] for i, home in enumerate(snapped.is_home)]
    actions: list[Action] = []
    for move in moves:
        for action, spot in _actions_of(snapped, tables, move, poses[move.block], spots[move.block]):
            spots[move.block] = spot
            turn = turn_between(action.start, action.end, snapped.problem.symmetry)
            if action.start.distance_to(action.end) > STRAIGHT or abs(turn) > STRAIGHT:
                poses[move.block] = action.end
                actions.append(action)
    return actions


def _actions_of(
    snapped: SnappedProblem, tables: Tables, move: BlockMove, pose: PlanarPose, spot: Array
) -> list[tuple[Action, Array]]:
    """One action, or two by way of a staging pose, each with the spot it ends at."""
    name, end = snapped.ids[move.block], tables.poses[move.spot]
    if move.grasps == PUSHED:
        return [(Push(name, pose, PlanarPose(float(end[0]), float(end[1]), pose.yaw)), end)]
    first = end if move.stage == NO_STAGE else tables.stage[move.block, move.stage]
    axes = divmod(move.grasps, 2)
    placed = carried(snapped.problem, name, pose, spot, first, axes)
    actions: list[tuple[Action, Array]] = [(placed, first)]
    if move.stage != NO_STAGE:
        actions.append(
            (Push(name, placed.end, PlanarPose(float(end[0]), float(end[1]), placed.end.yaw)), end)
        )
    return actions
