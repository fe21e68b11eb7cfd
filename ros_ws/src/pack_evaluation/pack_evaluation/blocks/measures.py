"""What a recorded rearrangement amounts to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.blocks.planar import turn_between
from pack_evaluation.blocks.from_bag import BlocksRun
from pack_evaluation.table import Row


@dataclass(frozen=True)
class BlocksMeasures:
    """Errors are true ones, from the simulator; perception's are against the truth at the exposure.

    Attributes:
        success: the executor says that all blocks are in place.
        exit_reason: how it ended.
        message: the same in words.
        error_mm: distance of every block from its goal, by id.
        turn_deg: turn of every block from its goal, by id.
        actions: carried out.
        planned: actions of the first plan.
        lower_bound: no plan has fewer.
        plans: asked for.
        failed_grasps: grasps that held nothing.
        refusals: actions that the arm could not do.
        deviations: actions after which the table was not as predicted.
        disturbances: actions that moved a block they were not on.
        pictures: taken.
        unclear: blocks not seen, or seen twice, over all pictures.
        seen_mm: errors of perceived centres: mean, largest.
        seen_deg: errors of perceived yaws: mean, largest.
        duration_s: simulated.
    """

    success: bool
    exit_reason: str
    message: str
    error_mm: dict[str, float]
    turn_deg: dict[str, float]
    actions: int
    planned: int
    lower_bound: int
    plans: int
    failed_grasps: int
    refusals: int
    deviations: int
    disturbances: int
    pictures: int
    unclear: int
    seen_mm: tuple[float, float]
    seen_deg: tuple[float, float]
    duration_s: float


def measure(run: BlocksRun) -> BlocksMeasures:
    """Measure a run."""
    result, problem = run.result, run.problem
    final = run.poses_at(float(run.times[-1]))
    first = run.plans[0] if run.plans else None
    seen_mm, seen_deg = _perception_errors(run)
    return BlocksMeasures(
        result["success"], result["exit_reason"], result["message"],
        {name: 1000 * final[name].distance_to(goal) for name, goal in problem.goals.items()},
        {
            name: float(np.rad2deg(abs(turn_between(final[name], goal, problem.symmetry))))
            for name, goal in problem.goals.items()
        },
        result["picks"] + result["pushes"], len(first.actions) if first else 0,
        first.lower_bound if first else 0, result["plans"], result["failed_grasps"],
        result["refusals"], result["deviations"], result["disturbances"], len(run.sights),
        sum(len(sight.unclear) for sight in run.sights), _mean_max(seen_mm), _mean_max(seen_deg),
        result["execution_time"],
    )  # fmt: skip


def rows(m: BlocksMeasures) -> tuple[Row, ...]:
    """The measures in words, most important first."""
    return (
        Row("arranged", "yes" if m.success else "no", m.message),
        Row("position", f"{max(m.error_mm.values()):.2f} mm", "of the worst block from its goal, true"),
        Row("turn", f"{max(m.turn_deg.values()):.2f} deg", "of the worst block from its goal, true"),
        Row("actions", f"{m.actions}", f"carried out; first plan {m.planned}, no plan under {m.lower_bound}"),
        Row("plans", str(m.plans), "asked for, with the last one that finds nothing to do"),
        Row("failed grasps", str(m.failed_grasps), "held nothing, or lost it"),
        Row("refusals", str(m.refusals), "actions that the arm could not do, and that were planned around"),
        Row("deviations", str(m.deviations), "actions after which the table was not as predicted"),
        Row("disturbances", str(m.disturbances), "actions that moved a block they were not on by 1 mm"),
        Row("pictures", str(m.pictures), f"{m.unclear} blocks not seen, or seen twice, in all of them"),
        Row("perceived centre", _pair(m.seen_mm, "mm"), "mean, largest error against the truth"),
        Row("perceived yaw", _pair(m.seen_deg, "deg"), "mean, largest error against the truth"),
        Row("duration", f"{m.duration_s:.1f} s", "simulated"),
    )


def _perception_errors(run: BlocksRun) -> tuple[list[float], list[float]]:
    distances, turns = [], []
    for sight in run.sights:
        truth = run.poses_at(sight.time)
        for name, pose in sight.poses.items():
            distances.append(1000 * pose.distance_to(truth[name]))
            turns.append(float(np.rad2deg(abs(turn_between(pose, truth[name])))))
    return distances, turns


def _mean_max(values: Sequence[float]) -> tuple[float, float]:
    return (float(np.mean(values)), float(np.max(values))) if values else (np.nan, np.nan)


def _pair(values: tuple[float, float], unit: str) -> str:
    return f"{values[0]:.3f}, {values[1]:.3f} {unit}"
