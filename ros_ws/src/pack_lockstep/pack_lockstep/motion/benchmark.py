"""The benchmark of motion planning: requests, planners on the same requests, and what is told of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np

from pack_core.cells import cell_part, cells_with
from pack_core.errors import ConfigError
from pack_core.motion.moves import Transfer
from pack_core.motion.target import MotionTarget
from pack_evaluation.spread import spread
from pack_lockstep.motion.bound import least_duration, require_toppra
from pack_lockstep.motion.checker import PlanChecker
from pack_lockstep.motion.harder import harder_requests
from pack_lockstep.motion.requests import MotionRequest, load_requests, request_file, save_requests
from pack_motion.arm.arm import MotionArm, load_arm
from pack_motion.clearance.check import ClearanceCheck, Conflict, Surrounding
from pack_motion.clearance.detour import DetourSearch
from pack_motion.clearance.transfer import TransferPlanner, WaySearch
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState, MoveRefused
from pack_motion.target_planner import TargetPlanner
from pack_motion.tracking.config import MotionSet, motion_set

RECORDED, HARDER = "recorded", "harder"
SETS = (RECORDED, HARDER)
"""Sets of requests, each a file."""
REQUESTS_PER_CELL, HARDER_REQUESTS, HARDER_SEED = 100, 100, 0


class RequestPlanner(Protocol):
    """What is measured."""

    def plan(self, start: JointState, target: MotionTarget) -> MotionPlan:
        """The plan for a target; MoveRefused where there is none."""


class HeightPlanner:
    """The shipped planner without ways around: transfers vary the lengths of their lines alone."""

    def __init__(
        self, arm: MotionArm, config: MotionSet, search: Callable[..., WaySearch] = DetourSearch
    ) -> None:
        check = ClearanceCheck(arm, config.clearance)
        self._all = TargetPlanner(arm, config.clearance, config.limit_share)
        self._transfers = TransferPlanner(arm, PathPlanner(arm, config.limit_share), check, search)

    def plan(self, start: JointState, target: MotionTarget) -> MotionPlan:
        """See `RequestPlanner`."""
        if not isinstance(target.move, Transfer):
            return self._all.plan(start, target)
        around = Surrounding(target.obstacles, target.carried, target.contacts, target.opening)
        found = self._transfers.by_height(start, target.move, around)
        if isinstance(found, Conflict):
            raise MoveRefused(found.text)
        return found


def _shipped(arm: MotionArm, config: MotionSet) -> RequestPlanner:
    return TargetPlanner(arm, config.clearance, config.limit_share)


class DetourPlanner(HeightPlanner):
    """Searches a way for every transfer, whether height alone is enough or not; paths have a given shape."""

    def plan(self, start: JointState, target: MotionTarget) -> MotionPlan:
        """See `RequestPlanner`."""
        if not isinstance(target.move, Transfer):
            return self._all.plan(start, target)
        around = Surrounding(target.obstacles, target.carried, target.contacts, target.opening)
        plan = self._transfers.detoured(start, target.move, around)
        if plan is None:
            raise MoveRefused("no way was found")
        return plan


def _ompl(arm: MotionArm, config: MotionSet) -> RequestPlanner:
    from pack_lockstep.motion.ompl_search import OmplSearch, require_ompl

    require_ompl()
    return DetourPlanner(arm, config, OmplSearch)


PLANNERS: dict[str, Callable[[MotionArm, MotionSet], RequestPlanner]] = {
    "shipped": _shipped, "height": HeightPlanner, "detour": DetourPlanner, "ompl": _ompl,
}  # fmt: skip
"""By name: what ships, its search of heights alone, its search of ways alone, and OMPL's in its place."""


@dataclass(frozen=True)
class PlanningTrial:
    """One request put to one planner.

    Attributes:
        requests: the set, and the cell of the arm.
        planner: its name.
        name: of the request.
        problem: why there is no plan, or what the checker says against it; empty for a success.
        planning_ms: processor time of the thread that planned.
        duration_s: of the plan; None without one.
        bound_s: the least duration of the plan's path; None without a plan, or without toppra.
    """

    requests: str
    planner: str
    name: str
    problem: str
    planning_ms: float
    duration_s: float | None
    bound_s: float | None


def record_requests() -> None:
    """Record both sets anew: run orders and problems in lockstep, and put intruders into their transfers."""
    recorded: list[MotionRequest] = []
    for cell in cells_with("motion_requests"):
        found = cell_part(cell, "motion_requests")()
        picked = np.linspace(0, len(found) - 1, REQUESTS_PER_CELL).round().astype(int)
        recorded += [found[i] for i in picked]
    save_requests(request_file(RECORDED), recorded)
    save_requests(request_file(HARDER), harder_requests(recorded, HARDER_REQUESTS, HARDER_SEED))


def count_trials(sets: Sequence[str], planners: Sequence[str]) -> int:
    """How many trials `run_motion_benchmark` makes.

    Raises:
        ConfigError: there is no such set or planner.
    """
    for what, names, known in (("set", sets, SETS), ("planner", planners, tuple(PLANNERS))):
        if unknown := [name for name in names if name not in known]:
            raise ConfigError(f"no {what} '{unknown[0]}'; allowed: {', '.join(known)}")
    return len(planners) * sum(len(load_requests(request_file(name))) for name in sets)


def run_motion_benchmark(sets: Sequence[str], planners: Sequence[str]) -> Iterator[PlanningTrial]:
    """Put every request of the sets to every planner, one after the other; see `count_trials`."""
    config = motion_set("shipped")
    for name in sets:
        requests = load_requests(request_file(name))
        for cell in dict.fromkeys(request.cell for request in requests):
            arm, own = load_arm(cell), [request for request in requests if request.cell == cell]
            made = {planner: PLANNERS[planner](arm, config) for planner in planners}
            for planner in made.values():  # what is compiled or loaded at first use is not measured
                _timed(planner, own[-1])
            checker = PlanChecker(arm, config.clearance)
            for request in own:
                for planner_name, planner in made.items():
                    plan, problem, planning_ms = _timed(planner, request)
                    if plan is not None:
                        problem = checker.check(request, plan).problem
                    bound = None if plan is None else _bound(arm, plan, config.limit_share)
                    yield PlanningTrial(
                        f"{name}, {cell}", planner_name, request.name, problem, planning_ms,
                        None if plan is None else plan.trajectory.duration, bound,
                    )  # fmt: skip


def _timed(planner: RequestPlanner, request: MotionRequest) -> tuple[MotionPlan | None, str, float]:
    plan, problem, before = None, "", time.thread_time()
    try:
        plan = planner.plan(request.start, request.target)
    except MoveRefused as refusal:
        problem = str(refusal)
    return plan, problem, 1000.0 * (time.thread_time() - before)


def _bound(arm: MotionArm, plan: MotionPlan, share: float) -> float | None:
    try:
        require_toppra()
    except ConfigError:
        return None
    return least_duration(arm, plan, share)


MOTION_COLUMNS = (
    "requests", "planner", "success", "planning, median, 95 % [ms]", "duration, mean [s]",
    "over bound, median, 95 %",
)  # fmt: skip


def motion_summary(trials: Sequence[PlanningTrial]) -> list[dict[str, Any]]:
    """How each planner did on each set of requests, as plain values; the sets in their order."""
    kinds = list(dict.fromkeys((trial.requests, trial.planner) for trial in trials))
    return [
        _of_kind([trial for trial in trials if (trial.requests, trial.planner) == kind]) for kind in kinds
    ]


def _of_kind(trials: Sequence[PlanningTrial]) -> dict[str, Any]:
    good = [trial for trial in trials if not trial.problem]
    ratios = [
        trial.duration_s / trial.bound_s for trial in good if trial.duration_s and trial.bound_s
    ]  # fmt: skip
    return {
        "requests": trials[0].requests,
        "planner": trials[0].planner,
        "trials": len(trials),
        "successes": len(good),
        "problems": {trial.name: trial.problem for trial in trials if trial.problem},
        "planning_ms": asdict(spread([trial.planning_ms for trial in trials])),
        "duration_s": asdict(spread([trial.duration_s for trial in good if trial.duration_s is not None])),
        "over_bound": asdict(spread(ratios)) if ratios else None,
    }


def motion_row(summary: dict[str, Any]) -> tuple[str, ...]:
    """A summary as a row of `MOTION_COLUMNS`."""
    ms, over = summary["planning_ms"], summary["over_bound"]
    mean = summary["duration_s"]["mean"]
    return (
        summary["requests"], summary["planner"], f"{summary['successes']} of {summary['trials']}",
        f"{ms['median']:.0f}, {ms['p95']:.0f}", "" if mean is None else f"{mean:.2f}",
        "" if over is None else f"{over['median']:.3f}, {over['p95']:.3f}",
    )  # fmt: skip
