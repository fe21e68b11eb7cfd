"""The rearrangement planner: one entry, two methods."""

from __future__ import annotations

import time
from typing import Literal, get_args

import numpy as np
from pydantic import Field

from pack_core.blocks.deed import is_refused
from pack_core.blocks.plan import Action, Diagnosis, Plan, PlanStatus
from pack_core.blocks.problem import Problem
from pack_core.config import Config
from pack_core.errors import PackError
from pack_planner.rearrangement.beam.beam_planner import BeamConfig, plan_by_beam
from pack_planner.rearrangement.beam.spots import MAX_BLOCKS
from pack_planner.rearrangement.certificates import find_certificate
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.lower_bound import lower_bound, sharper_bound
from pack_planner.rearrangement.pirs.pirs_planner import PirsConfig, plan_by_pirs
from pack_planner.rearrangement.progress import Clock, Progress
from pack_planner.rearrangement.task import Task
from pack_planner.rearrangement.validation import find_fault

Method = Literal["beam", "pirs"]
METHODS: tuple[Method, ...] = get_args(Method)
MOST_BLOCKS: dict[Method, int] = {"beam": MAX_BLOCKS, "pirs": 64}


class RearrangementConfig(Config):
    """Parameters of both methods."""

    beam: BeamConfig = Field(default_factory=BeamConfig)
    pirs: PirsConfig = Field(default_factory=PirsConfig)


WARM_UP = RearrangementConfig(beam=BeamConfig(widths=(16,), rounds=1))
"""Enough to have run everything once."""


def plan(
    problem: Problem, *, method: str = "beam", budget_s: float = 1.0, seed: int = 0,
    config: RearrangementConfig | None = None, clock: Clock = time.perf_counter,
) -> Plan:  # fmt: skip
    """Plan how to bring every block to its goal.

    Blocks within tolerance of their goals count as there, and blocks within tolerance of a push line of
    theirs as on it. So to replan, plan again from the poses observed.

    Args:
        problem: blocks, goals, workspace, gripper.
        method: `beam`, or `pirs` for the baseline.
        budget_s: time for planning [s]; it ends earlier with an optimal plan, `pirs` with its first.
        seed: of what is drawn at random.
        config: parameters of the methods.
        clock: seconds from anywhere; decides when the time is over.

    Raises:
        PackError: the method or budget is not allowed.
    """
    checked = checked_method(method)
    if not budget_s > 0:
        raise PackError(f"the budget is {budget_s} s; allowed: above 0")
    progress, config = Progress(clock, budget_s), config or RearrangementConfig()
    if fault := find_fault(problem) or _too_many(problem, checked):
        return Plan(PlanStatus.INVALID_INPUT, diagnosis=fault, statistics=progress.statistics())
    task = Task.of(problem)
    if task.is_home.all():
        progress.found(0)
        return Plan(PlanStatus.OPTIMAL, statistics=progress.statistics())
    if certificate := find_certificate(task):
        return Plan(PlanStatus.INFEASIBLE, diagnosis=certificate, statistics=progress.statistics())
    bound, rng = lower_bound(task), np.random.default_rng(seed)
    progress.setup_s = progress.elapsed()
    if checked == "beam":
        actions, bound = plan_by_beam(task, bound, progress, rng, config.beam)
    else:
        actions = _without_refused(task, progress, rng, config.pirs)
        bound = sharper_bound(task, bound)
    if actions is None:
        text = f"no plan found in {progress.elapsed():.2f} s; that there is none is not proven"
        return Plan(PlanStatus.TIMEOUT, (), bound, Diagnosis(text), progress.statistics())
    status = PlanStatus.OPTIMAL if len(actions) <= bound else PlanStatus.FEASIBLE
    return Plan(status, tuple(actions), bound, statistics=progress.statistics())


def _without_refused(
    task: Task, progress: Progress, rng: np.random.Generator, config: PirsConfig
) -> list[Action] | None:
    """The first plan by pIRS, which knows no refusals, that needs nothing of what the arm refused."""
    refused = task.problem.refused
    actions = plan_by_pirs(task, progress, rng, config)
    while actions is not None and any(is_refused(action, refused) for action in actions):
        actions = None if progress.is_over() else plan_by_pirs(task, progress, rng, config)
    return actions


def warm_up() -> None:
    """Compile both methods, or load what was compiled before, so that no later call has to."""
    for method in METHODS:
        plan(make_instance(4, 0.1, 0), method=method, budget_s=np.inf, config=WARM_UP)


def _too_many(problem: Problem, method: Method) -> Diagnosis | None:
    if len(problem.blocks) <= MOST_BLOCKS[method]:
        return None
    return Diagnosis(f"{len(problem.blocks)} blocks; allowed: up to {MOST_BLOCKS[method]} with {method}")


def checked_method(name: str) -> Method:
    """The method called `name`.

    Raises:
        PackError: there is none.
    """
    if name not in METHODS:
        raise PackError(f"method is '{name}'; allowed: {', '.join(METHODS)}")
    return name
