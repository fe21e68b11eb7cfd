"""pIRS, the paper's recursive search over the order of the blocks (Algorithms 1 and 2).

Sotiropoulos and Sandzimier, "Rearranging blocks into densely packed configurations", after Krontiris and
Bekris, "Dealing with difficult instances of object rearrangement". What is mended of the pseudocode:

- Algorithm 1, line 7 takes away o_b, which is not defined there; it must be o_r.
- Where there is no path at all, O_b is empty and has no "block in O_b": that is a failure.
- alpha_C is changed in place (line 3) and would keep the changes of a branch that failed; here every call has
  its own. Nor does a call whose own path was free, but whose children failed, return what it did in vain.
- CLEAR returns the configuration as well as the actions when it fails, too.
- CLEAR(o_b, O_R without o_b) treats o, for which o_b makes way, as fixed, so that two blocks that obstruct
  each other can never be parted; here o is among the blocks that may be moved.
- Only one block of O_b was tried; here each is, in random order. And a sampled pose may lie on the very path
  that is to be cleared; here it must not.
- Nothing bounds the recursion. Here its depth is bounded, and a search that has planned many paths in vain
  starts again with other random choices, and more patience.

Section V proposes three changes, which are options here and off by default: a price of distance (a block that
makes way then takes the nearest of several poses), a price of a push's length, and a block that makes way
trying its goal first. A block that has come home that way needs no path in its turn.

Not mended, since it is the method: a block that was brought home stays there, so that a bad order is noticed
only when no way into the grid is left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_baselines.pirs.geometry import Sizes
from pack_baselines.pirs.roadmap import (
    PUSHED,
    Prices,
    Way,
    is_clear,
    sample_clear_pose,
    sample_nodes,
    shortest_way,
)
from pack_core.blocks.plan import Action, Push
from pack_core.blocks.planar import PlanarPose, turn_between
from pack_core.blocks.primitive_action import is_refused
from pack_core.config import Config
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import outlines
from pack_planner.rearrangement.lower_bound import sharper_bound
from pack_planner.rearrangement.rearrangement_planner import Found, PlanningTimer, RearrangementPlanner
from pack_planner.rearrangement.snapped_problem import FITTING, SnappedProblem, carried

NEAREST_OF = 8
"""Clear poses of which a block that makes way takes the nearest, where distance has a price."""


class Costs(Config):
    """What the edges of a roadmap cost, Eq. 1 and Section V."""

    pick_place: PositiveFloat = Field(1.0, description="alpha_1")
    push: PositiveFloat = Field(1.5, description="alpha_2; a push is less precise")
    collision: PositiveFloat = Field(2.0, description="alpha_3, for every block in the way")
    distance: NonNegativeFloat = Field(0.0, description="of a block's way, Section V [1/m]")
    push_length: NonNegativeFloat = Field(0.0, description="of a push's length beyond that, Section V [1/m]")

    @property
    def prices(self) -> Prices:
        """As compiled code takes them."""
        return Prices(self.pick_place, self.push, self.collision, self.distance, self.push_length)


class PirsPlanner(RearrangementPlanner):
    """The first plan that pIRS finds; its parameters are those of the search and its roadmaps."""

    samples: PositiveInt = Field(60, description="N, intermediate poses of a roadmap")
    costs: Costs = Field(default_factory=Costs)
    bias: float = Field(0.5, ge=0.0, le=1.0, description="epsilon, share of them on push lines")
    depth: PositiveInt = Field(8, description="calls of CLEAR within each other")
    tries: PositiveInt = Field(200, description="poses drawn for a block to be cleared")
    clear_to_goal: bool = Field(False, description="a block to be cleared tries its goal first, Section V")
    patience: PositiveInt = Field(20, description="paths planned a block before the first new start")
    impatience: PositiveFloat = Field(1.3, description="growth of the patience at every new start")

    def plan(
        self, snapped: SnappedProblem, lower_bound: int, timer: PlanningTimer, rng: np.random.Generator
    ) -> Found:
        """Search anew until a plan needs nothing of what the arm refused, which pIRS itself does not know."""
        refused = snapped.problem.refused
        actions = self._first_plan(snapped, timer, rng)
        while actions is not None and any(is_refused(action, refused) for action in actions):
            actions = None if timer.is_over() else self._first_plan(snapped, timer, rng)
        return Found(actions, sharper_bound(snapped, lower_bound))

    def _first_plan(
        self, snapped: SnappedProblem, timer: PlanningTimer, rng: np.random.Generator
    ) -> list[Action] | None:
        """The first plan that is found; None where there is none in time."""
        away = frozenset(int(i) for i in np.flatnonzero(~snapped.is_home))
        patience = float(self.patience * snapped.n)
        while away:
            search = PirsSearch(snapped, timer, rng, self, int(patience))
            try:
                for o in search.shuffled(away):
                    if outcome := search.pirs(o, away - {o}, snapped.starts.copy()):
                        timer.found(outcome[0])
                        return outcome[0]
            except GiveUp:
                patience *= self.impatience
            if timer.is_over():
                return None
        return []


class GiveUp(Exception):
    """The search is to start again, or the time is over."""


PirsOutcome = tuple[list[Action], Array] | None
"""Actions and the configuration `(n, 3)` that they lead to; None for a failure."""


class KeptWay(NamedTuple):
    """The way of a block, to be kept free of others."""

    block: int
    way: Way


class PirsSearch:
    """One start of the search; sets of blocks are called as in the paper."""

    def __init__(
        self,
        snapped: SnappedProblem,
        timer: PlanningTimer,
        rng: np.random.Generator,
        config: PirsPlanner,
        patience: int,
    ) -> None:
        self._snapped, self._timer, self._rng, self._config = snapped, timer, rng, config
        self._patience = patience
        self._sizes = [Sizes.of(shape, snapped.gripper) for shape in snapped.shapes]
        self._prices = config.costs.prices
        self._corners = np.array(snapped.problem.workspace, dtype=float)

    def pirs(self, o: int, O_R: frozenset[int], alpha_C: Array) -> PirsOutcome:
        """Algorithm 1: bring o home, then the remaining ones O_R."""
        way = self._way_home(o, alpha_C, O_R)
        if way is None:
            return None
        if not way.blocks:
            pi_U, alpha = self._act(o, way, alpha_C)
            if not O_R:
                return pi_U, alpha
            for o_r in self.shuffled(O_R):
                if rest := self.pirs(o_r, O_R - {o_r}, alpha):
                    return pi_U + rest[0], rest[1]
            return None
        for o_b in self.shuffled(_members(way.blocks)):
            if cleared := self._clear(o_b, (O_R | {o}) - {o_b}, alpha_C, KeptWay(o, way), self._config.depth):
                pi, alpha = cleared
                if rest := self.pirs(o, O_R, alpha):
                    return pi + rest[0], rest[1]
        return None

    def _clear(
        self, o: int, O_R: frozenset[int], alpha_C: Array, keep_free: KeptWay, depth: int
    ) -> PirsOutcome:
        """Algorithm 2: move o to where it is not in a way, together with what is in its own way."""
        if self._config.clear_to_goal and (home := self._clear_to_goal(o, O_R, alpha_C, keep_free)):
            return home
        pose = self._sample_new_pose(o, alpha_C, keep_free)
        way = None if pose is None else self._prm(o, alpha_C, pose, O_R)
        if way is None:
            return None
        if not way.blocks:
            return self._act(o, way, alpha_C)
        for o_b in self.shuffled(_members(way.blocks)):
            if depth > 1 and (
                cleared := self._clear(o_b, (O_R | {o}) - {o_b}, alpha_C, KeptWay(o, way), depth - 1)
            ):
                pi, alpha = cleared
                if rest := self._clear(o, O_R, alpha, keep_free, depth - 1):
                    return pi + rest[0], rest[1]
        return None

    def _clear_to_goal(self, o: int, O_R: frozenset[int], alpha_C: Array, keep_free: KeptWay) -> PirsOutcome:
        """Section V: bring o home where its goal is free, not in the way, and reached without clearing."""
        goal, others = self._snapped.goals[o], np.uint64((1 << self._snapped.n) - 1 & ~(1 << o))
        blocks = outlines(alpha_C, self._snapped.shapes)
        of_way, sizes = self._sizes[keep_free.block], self._sizes[o]
        if not is_clear(goal, keep_free.way, of_way, others, sizes, blocks, self._snapped.half_planes):
            return None
        way = self._prm(o, alpha_C, goal, O_R)
        return None if way is None or way.blocks or not len(way.grasps) else self._act(o, way, alpha_C)

    def _way_home(self, o: int, alpha_C: Array, O_R: frozenset[int]) -> Way | None:
        """The way of o to its goal; without edges where it has come home as it made way."""
        goal = self._snapped.goals[o]
        if self._config.clear_to_goal and self._is_home(o, alpha_C):
            # The action of a path from a pose to itself would pick the block up and put it down again.
            return Way(alpha_C[o][None], np.empty(0, np.int64), np.uint64(0))
        return self._prm(o, alpha_C, goal, O_R)

    def _is_home(self, o: int, alpha_C: Array) -> bool:
        pose, goal = PlanarPose(*alpha_C[o].tolist()), PlanarPose(*self._snapped.goals[o].tolist())
        turn = turn_between(pose, goal, self._snapped.problem.symmetry)
        return pose.distance_to(goal) < FITTING and abs(turn) < FITTING

    def _prm(self, o: int, alpha_C: Array, end: Array, O_R: frozenset[int]) -> Way | None:
        """PRM(o, alpha_C, alpha_F, O_R), where alpha_F differs by the pose `end` of o."""
        if self._patience <= 0 or self._timer.is_over():
            raise GiveUp
        self._patience -= 1
        self._timer.count(1)
        snapped, config = self._snapped, self._config
        movable = sum(1 << i for i in O_R)
        fixed = (1 << snapped.n) - 1 & ~movable & ~(1 << o)
        blocks = outlines(alpha_C, snapped.shapes)
        nodes = sample_nodes(
            alpha_C[o], end, config.samples, config.bias, np.uint64(fixed), self._sizes[o], blocks,
            snapped.half_planes, self._corners, self._rng,
        )  # fmt: skip
        way = shortest_way(
            nodes, blocks, np.uint64(movable), np.uint64(fixed), snapped.problem.symmetry == 4, self._prices,
            self._sizes[o],
        )  # fmt: skip
        # Numba gives an int for an unsigned integer, and would compile anew what takes a way with one.
        return way._replace(blocks=np.uint64(way.blocks)) if len(way.grasps) else None

    def _sample_new_pose(self, o: int, alpha_C: Array, keep_free: KeptWay) -> Array | None:
        """SAMPLE_NEW_POSE(o, alpha_C): hits no block, and does not lie on the way to be kept free."""
        others = np.uint64((1 << self._snapped.n) - 1 & ~(1 << o))
        poses = sample_clear_pose(
            alpha_C[o], keep_free.way, self._sizes[keep_free.block], others,
            NEAREST_OF if self._prices.distance else 1, self._config.tries, self._sizes[o],
            outlines(alpha_C, self._snapped.shapes), self._snapped.half_planes, self._corners,
            self._rng,
        )  # fmt: skip
        return poses[0] if len(poses) else None

    def _act(self, o: int, way: Way, alpha_C: Array) -> tuple[list[Action], Array]:
        """Actions along a way, and the configuration after it."""
        name, pose = self._snapped.ids[o], PlanarPose(*alpha_C[o].tolist())
        actions: list[Action] = []
        for spot, end, kind in zip(way.poses[:-1], way.poses[1:], way.grasps.tolist(), strict=True):
            if kind == PUSHED:
                actions.append(Push(name, pose, PlanarPose(float(end[0]), float(end[1]), pose.yaw)))
            else:
                actions.append(carried(self._snapped.problem, name, pose, spot, end, divmod(kind, 2)))
            pose = actions[-1].end
        alpha = alpha_C.copy()
        alpha[o] = pose.row
        return actions, alpha

    def shuffled(self, blocks: frozenset[int]) -> list[int]:
        """The blocks of a set in random order."""
        return [int(i) for i in self._rng.permutation(sorted(blocks))]


def _members(bits: np.uint64) -> frozenset[int]:
    return frozenset(i for i in range(64) if int(bits) >> i & 1)
