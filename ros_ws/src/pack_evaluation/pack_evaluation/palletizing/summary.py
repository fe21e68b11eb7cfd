"""Many runs of the palletizing cell in a few numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pack_evaluation.palletizing.state_times import StateTime, merged
from pack_evaluation.spread import mean, mean_p95_max

HOLD_LIMIT_MM = 10.0
"""A stack holds if no box shifts by more than this on the pallet [mm]."""
TRUE_PATH = "true_position_mm"
"""Measure that only simulated arms with imperfect gears have: the true tool off its path."""


@dataclass(frozen=True)
class OrderTrial:
    """One run of an order, its measures as plain values.

    Attributes:
        order: stem of the order's file, or the order's id in a recording.
        seed: seed of the arrival poses and of the detections' noise.
        measures: the fields of `OrderMeasures`.
        hold_mm: how far the finished stack shifts under 0.2 g [mm]; None if that was not tested.
        expected_mm: error of placed boxes that the cell's calibration predicts, `mean` and `p95` [mm]; None
            for a cell without a calibration.
    """

    order: str
    seed: int
    measures: Mapping[str, Any]
    hold_mm: float | None
    expected_mm: Mapping[str, float] | None = None


def summarize_orders(trials: Sequence[OrderTrial]) -> dict[str, Any]:
    """The figures of docs/cells/palletizing/results.md, over all runs.

    An order counts as complete if it is complete with every seed.
    """
    boxes = [box for trial in trials for box in trial.measures["boxes"]]
    errors = [box["error_mm"] for box in boxes if box["error_mm"] is not None]
    runs_of = {order: [t for t in trials if t.order == order] for order in sorted({t.order for t in trials})}
    holds = [trial.hold_mm for trial in trials if trial.hold_mm is not None]
    return {
        "orders": len(runs_of),
        "orders_complete": sum(all(t.measures["is_complete"] for t in runs) for runs in runs_of.values()),
        "runs": len(trials),
        "runs_complete": sum(trial.measures["is_complete"] for trial in trials),
        "boxes": len(boxes),
        "boxes_ok": sum(box["is_ok"] for box in boxes),
        "tracking_position_mm": _tracking(trials, "position_mm"),
        "tracking_orientation_deg": _tracking(trials, "orientation_deg"),
        "true_position_mm": _tracking([t for t in trials if t.measures.get(TRUE_PATH)], TRUE_PATH),
        "goal_position_mm": _tracking(trials, "goal_mm"),
        "placed_error_mm": mean_p95_max(errors),
        "expected_error_mm": _expected(trials),
        "placed_angle_deg": mean_p95_max([b["angle_deg"] for b in boxes if b["angle_deg"] is not None]),
        "shift_mm": mean_p95_max([shift for trial in trials for shift in trial.measures["shift_mm"]]),
        "cycle_s": cycles(boxes),
        "weight_error_kg": mean_p95_max(
            [abs(b["weight_error_kg"]) for b in boxes if b.get("weight_error_kg") is not None]
        ),
        "drops": sum(trial.measures["drops"] for trial in trials),
        "unwanted_contacts": sum(trial.measures["touches"] for trial in trials),
        "interruptions": sum(trial.measures["interruptions"] for trial in trials),
        "stack_hold": {"tested": len(holds), "held": sum(hold < HOLD_LIMIT_MM for hold in holds)},
        "grip": {
            key: max((box[key] for box in boxes if box[key] is not None), default=None)
            for key in ("coaxial_N", "shear_N", "moment_Nm")
        },
        "way_point_position_mm": _way_points(trials, "way_point_mm"),
        "way_point_orientation_deg": _way_points(trials, "way_point_deg"),
        "states": _states(trials),
        "visitors": _visitors(trials),
        "per_order": {order: _order(runs) for order, runs in runs_of.items()},
    }


def _states(trials: Sequence[OrderTrial]) -> dict[str, dict[str, float]]:
    """For each state: visits, mean duration, share of all time, and the tool's highest speed."""
    runs = [
        {label: StateTime(**values) for label, values in trial.measures.get("states", {}).items()}
        for trial in trials
    ]
    states = merged(runs)
    everything = sum(item.total_s for item in states.values()) or 1.0
    return {
        label: {
            "visits": item.visits, "mean_s": item.total_s / item.visits,
            "share": item.total_s / everything, "peak_mps": item.peak_mps,
        }
        for label, item in states.items()
    }  # fmt: skip


def _way_points(trials: Sequence[OrderTrial], key: str) -> dict[str, float] | None:
    """Mean over all runs of their means, and the largest value; None where none was recorded."""
    found = [trial.measures[key] for trial in trials if trial.measures.get(key)]
    if not found:
        return None
    return {"mean": float(np.mean([average for average, _ in found])), "max": max(most for _, most in found)}


def _expected(trials: Sequence[OrderTrial]) -> dict[str, float] | None:
    """What the cells' calibrations predict, as a mean over all boxes; None without a calibration."""
    found = [(trial.expected_mm, len(trial.measures["boxes"])) for trial in trials if trial.expected_mm]
    if not found:
        return None
    weights = [count for _, count in found]
    return {
        key: float(np.average([expected[key] for expected, _ in found], weights=weights))
        for key in ("mean", "p95")
    }


def _visitors(trials: Sequence[OrderTrial]) -> dict[str, Any] | None:
    """All crossings of visitors together; None where nobody came."""
    found = [trial.measures["visitors"] for trial in trials if trial.measures.get("visitors")]
    if not found:
        return None
    least = [distance for item in found for distance in item["least_m"]]
    return {
        **{key: sum(item[key] for item in found) for key in ("crossings", "too_near", "touches")},
        "least_m": min(least, default=None),
        "least_p5_m": float(np.percentile(least, 5)) if least else None,
        "least_median_m": float(np.median(least)) if least else None,
        "margin_m": min((m for item in found if (m := item.get("margin_m")) is not None), default=None),
        "near_s": sum(item["near_s"] for item in found),
        "stopped_s": sum(item["stopped_s"] for item in found),
    }


def cycles(boxes: Sequence[Mapping[str, Any]]) -> dict[str, float | None]:
    """Mean cycle time by handling, of all boxes, and boxes an hour."""
    times = {kind: [b["cycle_s"] for b in boxes if b["handling"] == kind and b["cycle_s"] is not None]
             for kind in ("none", "flip", "table")}  # fmt: skip
    everything = [time for kind in times.values() for time in kind]
    overall = mean(everything)
    return {
        **{kind: mean(values) for kind, values in times.items()},
        "none_or_flip": mean(times["none"] + times["flip"]),
        "mean": overall,
        "boxes_per_hour": None if overall is None else 3600.0 / overall,
    }


def _order(runs: Sequence[OrderTrial]) -> dict[str, Any]:
    boxes = [box for run in runs for box in run.measures["boxes"]]
    errors = [box["error_mm"] for box in boxes if box["error_mm"] is not None]
    return {
        "complete": sum(run.measures["is_complete"] for run in runs), "runs": len(runs),
        "boxes_ok": sum(box["is_ok"] for box in boxes), "boxes": len(boxes),
        "error_mm": mean_p95_max(errors), "cycle_s": mean([b["cycle_s"] for b in boxes if b["cycle_s"]]),
        "tracking_mm": _tracking(runs, "position_mm"),
        "shift_mm": mean_p95_max([shift for run in runs for shift in run.measures["shift_mm"]]),
        "faults": [fault for run in runs for fault in run.measures["faults"]],
        "hold_mm": [run.hold_mm for run in runs],
    }  # fmt: skip


def _tracking(trials: Sequence[OrderTrial], key: str) -> dict[str, float] | None:
    """Mean, weighted by the runs' durations, and largest value of a tracking error; None without a run.

    An order of which nothing was built took no time and counts for nothing.
    """
    weights = [trial.measures["duration_s"] for trial in trials]
    if not any(weights):
        return None
    means = [trial.measures[key][0] for trial in trials]
    return {
        "mean": float(np.average(means, weights=weights)),
        "max": max(trial.measures[key][1] for trial in trials),
    }
