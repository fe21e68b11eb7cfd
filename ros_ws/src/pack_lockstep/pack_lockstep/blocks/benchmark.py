"""The benchmark of the blocks cell: problems planned, checked, and carried out.

A plan's time is that of its thread on the processor, on which other programs have little influence.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any, ClassVar

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.plan import Plan, Push, to_record
from pack_core.blocks.problem import Problem
from pack_core.blocks.problem_file import problem_text
from pack_evaluation.blocks.plan_verifier import verify
from pack_lockstep.benchmarking.benchmark import Benchmark, Verdict
from pack_lockstep.blocks.benchmark_instances import Instance
from pack_lockstep.blocks.execution import execute
from pack_lockstep.blocks.lockstep import BlocksLockstepConfig, CountedPlannerConfig
from pack_planner.rearrangement.planning import plan, warm_up

WARM_UP = 0.2
"""Time of planning before anything is measured [s]."""


@dataclass(frozen=True)
class BlocksSetup:
    """What decides the results, the instances apart."""

    cell: BlocksCell
    lockstep: BlocksLockstepConfig
    budget: float
    """Processor time that a plan may take [s]."""
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
        """Tells the trial from every other one."""
        return f"{self.method}_{self.instance.name}"


def run_job(setup: BlocksSetup, job: PlanJob) -> dict[str, Any]:
    """Plan an instance, check the plan and, where asked to, carry the instance out; a line of the results.

    An execution plans for itself, by its work rather than by any time, so that it repeats.
    """
    _warm_up(job.method, job.instance.warm_up, setup.cell)
    problem, seed = job.instance.problem(setup.cell), job.instance.seed
    made = plan(
        problem, method=job.method, budget_s=setup.budget, seed=seed, config=setup.lockstep.planner,
        clock=time.thread_time,
    )  # fmt: skip
    execution = None
    if setup.with_execution:
        planner = CountedPlannerConfig.model_validate({"method": job.method, "seed": seed})
        done = execute(problem, setup.cell, planner, setup.lockstep)
        execution = {**asdict(done), "is_valid": done.is_valid, "is_ok": done.is_ok}
    return {
        "name": job.name, "method": job.method, "instance": job.instance.name, "seed": seed,
        "kind": job.instance.kind, "blocks": len(problem.blocks), "problem": problem_text(problem),
        **_measures(problem, made), "execution": execution,
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
        "pushed_m": sum(action.distance for action in made.actions if isinstance(action, Push)),
        "cleared": made.cleared(problem.goals), "regrasps": made.regrasps(),
        "plan": to_record(made.actions),
    }  # fmt: skip


@cache
def _warm_up(method: str, instance: Instance, cell: BlocksCell) -> None:
    """Once a process, without an end: what is measured is planning, not its compilation."""
    warm_up()
    plan(instance.problem(cell), method=method, budget_s=WARM_UP)


@dataclass(frozen=True)
class BlocksBenchmark(Benchmark[PlanJob, dict[str, Any]]):
    """Instances, each planned with every method."""

    cell: ClassVar[str] = "blocks"

    setup: BlocksSetup
    jobs: tuple[PlanJob, ...]

    @property
    def folder_name(self) -> str:
        """Which instances, the budget, and whether plans are carried out."""
        how = "executed" if self.setup.with_execution else "planned"
        kinds = ", ".join(dict.fromkeys(job.instance.kind for job in self.jobs))
        return f"{self.cell}_{how}_{re.sub(r'[^A-Za-z0-9.]+', '_', kinds)}_{self.setup.budget:g}s"

    def settings(self) -> Mapping[str, Any]:
        """Cell, parameters of all nodes, the budget, and whether plans are carried out."""
        return self.setup.record()

    @property
    def work(self) -> Callable[[PlanJob], dict[str, Any]]:
        """Plans an instance with a method, checks the plan, and carries it out."""
        return partial(run_job, self.setup)

    def keep(self, result: dict[str, Any], folder: Path) -> Mapping[str, Any]:
        """The measures; nothing is kept beside them."""
        return result

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """The plan, what the verifier found wrong with it, and how its execution went."""
        if not trial["is_solved"]:
            return Verdict(trial["name"], False, f"{trial['status']}: {trial['message']}")
        text = (
            f"{trial['status']:8} {trial['actions']:3} actions, bound {trial['lower_bound']:3}, "
            f"first plan {trial['first_plan_ms']:6.1f} ms"
        )
        if done := trial["execution"]:
            text += (
                f"  {done['exit_reason']}: {done['error_mm']:.2f} mm {done['angle_deg']:.2f} deg, bystanders "
                f"{done['disturbance_mm']:.2f} mm, slip {done['slip_mm']:.2f} mm, {done['duration_s']:.0f} s"
            )
        success = not trial["faults"] and (done is None or done["is_ok"])
        return Verdict(trial["name"], success, "; ".join([text, *trial["faults"]]))
