"""Many problems of the blocks cell: planned on the wall clock, checked, and carried out in lockstep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from pack_bringup.benchmarking.pools import Pool
from pack_bringup.benchmarking.trial_file import TrialFile, read_trials
from pack_bringup.blocks.execution import execute
from pack_bringup.blocks.lockstep import BlocksLockstepConfig
from pack_bringup.blocks.planning import CountedPlannerConfig
from pack_core.cells.blocks import BlocksCell
from pack_core.rearrangement.plan import Push
from pack_core.rearrangement.problem import Problem
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.planner import plan
from pack_planner.rearrangement.verifier import verify


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
    blocks: int
    density: float
    seed: int

    @property
    def name(self) -> str:
        """Of the trial."""
        return f"{self.method}_{self.blocks}_{self.density:g}_seed{self.seed}"

    def problem(self, cell: BlocksCell) -> Problem:
        """The instance, in the middle of the cell's workspace."""
        return make_instance(self.blocks, self.density, self.seed, centre=cell.workspace.centre)


def run_job(setup: Setup, job: PlanJob) -> dict[str, Any]:
    """Plan an instance, check the plan and, where asked to, carry the instance out; a line of the results."""
    _warm_up(job.method)
    problem = job.problem(setup.cell)
    made = plan(problem, method=job.method, budget_s=setup.budget, seed=job.seed)
    execution = None
    if setup.with_execution and made.is_solved:
        planner = CountedPlannerConfig.model_validate({"method": job.method, "seed": job.seed})
        done = execute(problem, setup.cell, planner, setup.lockstep)
        execution = {**asdict(done), "is_valid": done.is_valid, "is_ok": done.is_ok}
    return {
        "name": job.name, "method": job.method, "blocks": job.blocks, "density": job.density,
        "seed": job.seed, "status": made.status.name, "is_solved": made.is_solved,
        "faults": verify(problem, made) if made.is_solved else [],
        "first_plan_ms": 1000 * made.statistics.first_plan_s, "total_ms": 1000 * made.statistics.total_s,
        "actions": len(made.actions), "lower_bound": made.lower_bound, "travel_m": made.travel(),
        "pushes": sum(isinstance(action, Push) for action in made.actions), "execution": execution,
    }  # fmt: skip


@cache
def _warm_up(method: str) -> None:
    """Have the compiled parts loaded, once a process: what is measured is planning."""
    plan(make_instance(4, 0.08, 0), method=method, budget_s=0.1)


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
    """The lines of those of the jobs that the file has."""
    names = {job.name for job in jobs}
    return [line for name, line in read_trials(path)[1].items() if name in names]


def summarize(lines: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Counts, and the spread of each measure; times and actions over the solved instances."""
    solved = [line for line in lines if line["is_solved"]]
    executions = [line["execution"] for line in lines if line["execution"] is not None]
    summary: dict[str, Any] = {
        "instances": len(lines),
        "solved": len(solved),
        "verified": sum(not line["faults"] for line in solved),
        "at_lower_bound": sum(line["actions"] == line["lower_bound"] for line in solved),
    }
    for key in ("first_plan_ms", "total_ms", "actions", "lower_bound", "pushes", "travel_m"):
        summary[key] = spread([line[key] for line in solved])
    summary["executed"] = len(executions)
    summary["executed_ok"] = sum(execution["is_ok"] for execution in executions)
    summary["executed_valid"] = sum(execution["is_valid"] for execution in executions)
    for key in ("error_mm", "angle_deg", "disturbance_mm", "slip_mm", "slip_deg", "duration_s"):
        summary[key] = spread([float(execution[key]) for execution in executions])
    return summary


def spread(values: Sequence[float]) -> dict[str, float | None]:
    """Mean, 95th percentile and largest; None for no values."""
    if not values:
        return {"mean": None, "p95": None, "max": None}
    array = np.array(values, dtype=float)
    return {
        "mean": float(array.mean()), "p95": float(np.percentile(array, 95)), "max": float(array.max()),
    }  # fmt: skip
