"""The one entry to planning rearrangements, whichever planner is asked."""

from __future__ import annotations

import time

import numpy as np

from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus
from pack_core.blocks.problem import Problem
from pack_core.errors import PackError
from pack_planner.rearrangement.certificates import find_certificate
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.lower_bound import lower_bound
from pack_planner.rearrangement.methods import METHODS, RearrangementConfig
from pack_planner.rearrangement.rearrangement_planner import (
    Clock,
    Enough,
    PlanningTimer,
    RearrangementPlanner,
)
from pack_planner.rearrangement.snapped_problem import SnappedProblem
from pack_planner.rearrangement.validation import find_fault


def plan(
    problem: Problem, *, method: str = "beam", budget_s: float = 1.0, seed: int = 0,
    config: RearrangementConfig | None = None, clock: Clock = time.perf_counter,
    is_enough: Enough = lambda _: False,
) -> Plan:  # fmt: skip
    """Plan how to bring every block to its goal.

    Blocks within tolerance of their goals count as there, and blocks within tolerance of a push line of
    theirs as on it. So to replan, plan again from the poses observed.

    Args:
        problem: blocks, goals, workspace, gripper.
        method: name of the planner, one of METHODS.
        budget_s: time for planning [s]; a planner may end earlier, as `pirs` does with its first plan.
        seed: of what is drawn at random.
        config: all planners with their parameters; those by default where it is left out.
        clock: seconds from anywhere; decides when the time is over.
        is_enough: whether a plan that was found ends the planning; by default none does before the planner
            itself ends.

    Raises:
        PackError: the method or budget is not allowed.
    """
    config = config or RearrangementConfig()
    planner = config.planner(method)
    if not budget_s > 0:
        raise PackError(f"the budget is {budget_s} s; allowed: above 0")
    timer = PlanningTimer(clock, budget_s, is_enough)
    if fault := find_fault(problem) or _beyond(problem, method, planner):
        return Plan(PlanStatus.INVALID_INPUT, diagnosis=fault, statistics=timer.statistics())
    snapped = SnappedProblem.of(problem)
    if snapped.is_home.all():
        timer.found(())
        return Plan(PlanStatus.OPTIMAL, statistics=timer.statistics())
    if certificate := find_certificate(snapped):
        return Plan(PlanStatus.INFEASIBLE, diagnosis=certificate, statistics=timer.statistics())
    bound, rng = lower_bound(snapped), np.random.default_rng(seed)
    timer.setup_s = timer.elapsed()
    actions, bound = planner.plan(snapped, bound, timer, rng)
    if actions is None:
        text = f"no plan found in {timer.elapsed():.2f} s; that there is none is not proven"
        return Plan(PlanStatus.TIMEOUT, (), bound, Diagnosis(text), timer.statistics())
    status = PlanStatus.OPTIMAL if len(actions) <= bound else PlanStatus.FEASIBLE
    return Plan(status, tuple(actions), bound, statistics=timer.statistics())


def warm_up() -> None:
    """Compile every planner, or load what was compiled before, so that no later call has to."""
    planners = RearrangementConfig()
    quick = RearrangementConfig(**{name: planners.planner(name).for_warm_up() for name in METHODS})
    for method in METHODS:
        plan(make_instance(4, 0.1, 0), method=method, budget_s=np.inf, config=quick)


def _beyond(problem: Problem, method: str, planner: RearrangementPlanner) -> Diagnosis | None:
    """What is sound, but too much for a planner."""
    if len(problem.goals) > planner.most_blocks:
        return Diagnosis(f"{len(problem.goals)} blocks; allowed: up to {planner.most_blocks} with {method}")
    if problem.obstacles and not planner.avoids_obstacles:
        names = tuple(problem.obstacles)
        return Diagnosis(f"{', '.join(names)} in the way: {method} plans around nothing that stays", names)
    return None
