"""Many problems of the blocks cell: planned on the wall clock, checked, and carried out in lockstep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.plan import Plan, Push
from pack_core.blocks.plan_record import to_record
from pack_core.blocks.problem import Problem
from pack_evaluation.blocks.plan_verifier import verify
from pack_lockstep.benchmarking.pools import Pool
from pack_lockstep.benchmarking.trial_file import TrialFile, read_trials
from pack_lockstep.blocks.benchmark_instances import Instance
from pack_lockstep.blocks.execution import execute
from pack_lockstep.blocks.lockstep import BlocksLockstepConfig
from pack_lockstep.blocks.planning import CountedPlannerConfig
from pack_planner.rearrangement.planner import plan, warm_up

WARM_UP = 0.2
"""Of planning before anything is measured [s]."""


@dataclass(frozen=True)
class Setup:
    """What decides the results, the instances apart."""

    cell: BlocksCell
    lockstep: BlocksLockstepConfig
    budget: float
    """Of a plan [s of wall clock]."""
    with_execution: bool

    def record(self) -> dict[str, Any]:
        """All of it as plain values, for the head of the results."""
        return {
            "cell": self.cell.model_dump(mode="json"), "lockstep": self.lockstep.model_dump(mode="json"),
            "budget": self.budget, "with_execution": self.with_execution,
        }  # fmt: skip


@dataclass(frozen=True)
class PlanJob:
    """An instance to plan with a method."""

    method: str
    instance: Instance

    @property
    def name(self) -> str:
        """Of the trial."""
        return f"{self.method}_{self.instance.name}"


def run_job(setup: Setup, job: PlanJob) -> dict[str, Any]:
    """Plan an instance, check the plan and, where asked to, carry the instance out; a line of the results.

    An execution plans for itself, by its work rather than by the wall clock, so that it repeats.
    """
    _warm_up(job.method, job.instance.warm_up, setup.cell)
    problem, seed = job.instance.problem(setup.cell), job.instance.seed
    made = plan(problem, method=job.method, budget_s=setup.budget, seed=seed)
    execution = None
    if setup.with_execution:
        planner = CountedPlannerConfig.model_validate({"method": job.method, "seed": seed})
        done = execute(problem, setup.cell, planner, setup.lockstep)
        execution = {**asdict(done), "is_valid": done.is_valid, "is_ok": done.is_ok}
    return {
        "name": job.name, "method": job.method, "instance": job.instance.name, "seed": seed,
        "blocks": len(problem.blocks), **_measures(problem, made), "execution": execution,
    }  # fmt: skip


def _measures(problem: Problem, made: Plan) -> dict[str, Any]:
    """What is kept of a plan."""
    return {
        "status": made.status.name, "message": made.diagnosis.text, "is_solved": made.is_solved,
        "faults": verify(problem, made) if made.is_solved else [],
        "first_plan_ms": 1000 * made.statistics.first_plan_s, "total_ms": 1000 * made.statistics.total_s,
        "first_actions": made.statistics.first_actions, "actions": len(made.actions),
        "lower_bound": made.lower_bound, "travel_m": made.travel(),
        "pushes": sum(isinstance(action, Push) for action in made.actions),
        "plan": to_record(made.actions),
    }  # fmt: skip


@cache
def _warm_up(method: str, instance: Instance, cell: BlocksCell) -> None:
    """Once a process, without an end: what is measured is planning, not its compilation."""
    warm_up()
    plan(instance.problem(cell), method=method, budget_s=WARM_UP)


def run_jobs(path: Path, setup: Setup, jobs: Sequence[PlanJob], pool: Pool) -> Iterator[dict[str, Any]]:
    """Run what the file does not have yet, and keep each line when it is done.

    Raises:
        PackError: the file is of other settings.
    """
    file = TrialFile(path, setup.record())
    missing = [job for job in jobs if job.name not in file.trials]
    for line in pool.run(partial(run_job, setup), missing):
        file.add(line)
        yield line


def kept_lines(path: Path, jobs: Sequence[PlanJob]) -> list[dict[str, Any]]:
    """The lines of those of the jobs that the file has, in their order."""
    lines = read_trials(path)[1]
    return [lines[job.name] for job in jobs if job.name in lines]
