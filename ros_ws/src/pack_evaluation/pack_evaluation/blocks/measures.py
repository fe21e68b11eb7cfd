"""The measures of a recorded rearrangement."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from pack_core.blocks.planar import turn_between
from pack_evaluation.blocks.from_bag import BlocksRun
from pack_evaluation.table import MeasureText, mean_and_max, number, yes_or_no


def _worst(unit: str) -> Callable[[Mapping[str, float]], str]:
    return lambda by_id: f"{max(by_id.values()):.2f} {unit}"


@dataclass(frozen=True)
class BlocksMeasures:
    """What is measured of a rearrangement, most important first.

    Errors are true ones, from the simulator; perception's are against the truth at the exposure.
    """

    success: Annotated[bool, MeasureText("arranged", yes_or_no, lambda m: m.message)]
    exit_reason: str
    """How it ended according to the executor; `message` says the same in words."""
    message: str
    error_mm: Annotated[
        dict[str, float], MeasureText("position", _worst("mm"), "of the worst block from its goal, true")
    ]
    """By the block's id."""
    turn_deg: Annotated[
        dict[str, float], MeasureText("turn", _worst("deg"), "of the worst block from its goal, true")
    ]
    """By the block's id."""
    actions: Annotated[
        int,
        MeasureText(
            "actions", str, lambda m: f"carried out; first plan {m.planned}, no plan under {m.lower_bound}"
        ),
    ]
    planned: int
    """Actions of the first plan; no plan has fewer than `lower_bound`."""
    lower_bound: int
    plans: Annotated[int, MeasureText("plans", str, "asked for, with the last one that finds nothing to do")]
    failed_grasps: Annotated[
        int, MeasureText("failed grasps", str, "held nothing, lost it, or held something else")
    ]
    refusals: Annotated[
        int, MeasureText("refusals", str, "actions that the arm could not do, and that were planned around")
    ]
    deviations: Annotated[
        int, MeasureText("deviations", str, "actions after which the table was not as predicted")
    ]
    disturbances: Annotated[
        int, MeasureText("disturbances", str, "actions that moved a block they were not on by 1 mm")
    ]
    pictures: Annotated[
        int,
        MeasureText("pictures", str, lambda m: f"{m.unclear} blocks not seen, or seen twice, in all of them"),
    ]
    unclear: int
    seen_mm: Annotated[
        tuple[float, float],
        MeasureText("perceived centre", mean_and_max("mm"), "mean, largest error against the truth"),
    ]
    seen_deg: Annotated[
        tuple[float, float],
        MeasureText("perceived yaw", mean_and_max("deg"), "mean, largest error against the truth"),
    ]
    duration_s: Annotated[float, MeasureText("duration", number("s", 1), "simulated")]


def measure(run: BlocksRun) -> BlocksMeasures:
    """Measure a recorded rearrangement."""
    result, problem = run.result, run.problem
    final = run.poses_at(run.end)
    first = run.plans[0] if run.plans else None
    seen_mm, seen_deg = _perception_errors(run)
    turns = {name: turn_between(final[name], goal, problem.symmetry) for name, goal in problem.goals.items()}
    return BlocksMeasures(
        success=result["success"], exit_reason=result["exit_reason"], message=result["message"],
        error_mm={name: 1000 * final[name].distance_to(goal) for name, goal in problem.goals.items()},
        turn_deg={name: float(np.rad2deg(abs(turn))) for name, turn in turns.items()},
        actions=result["picks"] + result["pushes"], planned=len(first.actions) if first else 0,
        lower_bound=first.lower_bound if first else 0, plans=result["plans"],
        failed_grasps=result["failed_grasps"], refusals=result["refusals"],
        deviations=result["deviations"], disturbances=result["disturbances"], pictures=len(run.sights),
        unclear=sum(len(sight.unclear) for sight in run.sights), seen_mm=_mean_max(seen_mm),
        seen_deg=_mean_max(seen_deg), duration_s=result["execution_time"],
    )  # fmt: skip


def _perception_errors(run: BlocksRun) -> tuple[list[float], list[float]]:
    distances, turns = [], []
    for sight in run.sights:
        truth = run.poses_at(sight.time)
        for name in sight.poses.keys() & truth.keys():
            pose = sight.poses[name]
            distances.append(1000 * pose.distance_to(truth[name]))
            turns.append(float(np.rad2deg(abs(turn_between(pose, truth[name])))))
    return distances, turns


def _mean_max(values: Sequence[float]) -> tuple[float, float]:
    return (float(np.mean(values)), float(np.max(values))) if values else (np.nan, np.nan)
