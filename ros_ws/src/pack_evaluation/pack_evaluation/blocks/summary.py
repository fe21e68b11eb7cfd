"""Statistics of many planned and executed rearrangements as plain values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from pack_evaluation.blocks.measures import BlocksMeasures
from pack_evaluation.spread import mean_p95_max

Line = Mapping[str, Any]
OF_PLANS = {
    "first_plan_ms": "first plan [ms]",
    "first_actions": "actions of the first plan",
    "total_ms": "planning [ms]",
    "actions": "actions",
    "lower_bound": "no plan has fewer than",
    "pushes": "pushes among them",
    "pushed_m": "length of these pushes, summed [m]",
    "travel_m": "travel of the gripper [m]",
}
OF_EXECUTIONS = {
    "error_mm": "farthest block from its goal [mm]",
    "angle_deg": "most turned block [deg]",
    "disturbance_mm": "bystander moved [mm]",
    "slip_mm": "slip in the hand [mm]",
    "slip_deg": "turn in the hand [deg]",
    "duration_s": "simulated time [s]",
}


def summarize(lines: Sequence[Line]) -> dict[str, Any]:
    """Counts, and statistics of each measure; measures of plans are taken over the solved instances."""
    solved = [line for line in lines if line["is_solved"]]
    executions = [line["execution"] for line in lines if line["execution"] is not None]
    summary: dict[str, Any] = {
        "instances": len(lines),
        "statuses": dict(Counter(line["status"] for line in lines)),
        "solved": len(solved),
        "verified": sum(not line["faults"] for line in solved),
        "at_lower_bound": sum(line["actions"] == line["lower_bound"] for line in solved),
        **{key: mean_p95_max([line[key] for line in solved]) for key in OF_PLANS},
        "executed": len(executions),
        "executed_ok": sum(execution["is_ok"] for execution in executions),
        "executed_valid": sum(execution["is_valid"] for execution in executions),
    }
    return summary | {key: mean_p95_max([done[key] for done in executions]) for key in OF_EXECUTIONS}


def summarize_recordings(measured: Sequence[BlocksMeasures]) -> dict[str, Any]:
    """Counts, and statistics of the measures of each recording, errors being those of its worst block."""
    return {
        "recordings": len(measured),
        "arranged": sum(m.success for m in measured),
        "exit_reasons": dict(Counter(m.exit_reason for m in measured)),
        "error_mm": mean_p95_max([max(m.error_mm.values()) for m in measured]),
        "turn_deg": mean_p95_max([max(m.turn_deg.values()) for m in measured]),
        "actions": mean_p95_max([m.actions for m in measured]),
        "plans": mean_p95_max([m.plans for m in measured]),
        "duration_s": mean_p95_max([m.duration_s for m in measured]),
    }
