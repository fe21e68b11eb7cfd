"""What a benchmark of the blocks cell amounts to: counts, spreads, and methods side by side."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pack_evaluation.table import TextTable
from pack_planner.rearrangement.planner import Method

Line = Mapping[str, Any]
OF_PLANS = {
    "first_plan_ms": "first plan [ms]",
    "first_actions": "actions of the first plan",
    "total_ms": "planning [ms]",
    "actions": "actions",
    "lower_bound": "no plan has fewer than",
    "pushes": "pushes among them",
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
PARTS = {"mean": "mean", "p95": "95 %", "max": "largest"}


def summarize(lines: Sequence[Line]) -> dict[str, Any]:
    """Counts, and the spread of each measure; those of plans over the instances solved."""
    solved = [line for line in lines if line["is_solved"]]
    executions = [line["execution"] for line in lines if line["execution"] is not None]
    summary: dict[str, Any] = {
        "instances": len(lines),
        "statuses": dict(Counter(line["status"] for line in lines)),
        "solved": len(solved),
        "verified": sum(not line["faults"] for line in solved),
        "at_lower_bound": sum(line["actions"] == line["lower_bound"] for line in solved),
        **{key: spread([line[key] for line in solved]) for key in OF_PLANS},
        "executed": len(executions),
        "executed_ok": sum(execution["is_ok"] for execution in executions),
        "executed_valid": sum(execution["is_valid"] for execution in executions),
    }
    return summary | {key: spread([execution[key] for execution in executions]) for key in OF_EXECUTIONS}


def spread(values: Sequence[float]) -> dict[str, float | None]:
    """Mean, 95th percentile and largest; None for no values."""
    if not values:
        return dict.fromkeys(PARTS)
    array = np.array(values, dtype=float)
    p95 = float(np.percentile(array, 95))
    return {"mean": float(array.mean()), "p95": p95, "max": float(array.max())}


def comparison(summaries: Mapping[Method, Mapping[str, Any]], title: str) -> TextTable:
    """Methods side by side, a row a measure."""
    counts = {
        "solved": ("solved", "instances"),
        "plans accepted by the verifier": ("verified", "solved"),
        "as short as the lower bound": ("at_lower_bound", "solved"),
        "carried out well": ("executed_ok", "executed"),
    }
    rows = [
        (name, *(f"{s[part]} of {s[whole]}" for s in summaries.values()))
        for name, (part, whole) in counts.items()
        if any(s[whole] for s in summaries.values())
    ]
    rows += [
        (name, *(_cell(s[key]) for s in summaries.values()))
        for key, name in (OF_PLANS | OF_EXECUTIONS).items()
        if any(s[key]["mean"] is not None for s in summaries.values())
    ]
    note = f"Of every measure: {', '.join(PARTS.values())}; those of plans over the instances solved."
    return TextTable(title, note, ("", *summaries), tuple(rows))


def _cell(values: Mapping[str, float | None]) -> str:
    return "   ".join("-" if values[part] is None else f"{values[part]:.2f}" for part in PARTS)
