"""Result and report of a fill job as messages."""

from __future__ import annotations

import json

from pack_interfaces.action import FillContainer

from pack_core.packing.free_space import Fill
from pack_mpc.ros.fill_goal import FillGoal


def to_fill_result(goal: FillGoal, time: float) -> FillContainer.Result:
    """The result of a job that has ended."""
    report, fill = goal.job.report, _fill(goal)
    given, packed = goal.given, len(report.packed)
    return FillContainer.Result(
        success=packed == given, exit_reason=goal.exit_reason, message=goal.message, packed=packed,
        given=given,
        base_area=fill.base_area, volume=fill.volume, execution_time=time - goal.start,
        report=to_fill_report(goal),
    )  # fmt: skip


def to_fill_report(goal: FillGoal) -> str:
    """Each object's fate, and the fill over time, as JSON; times in [s], shares from 0 to 1."""
    return json.dumps(
        {
            "exit_reason": goal.exit_reason, "message": goal.message, "start": goal.start,
            "force_peak": goal.force_peak, **_so_far(goal),
        }
    )  # fmt: skip


def to_fill_progress(goal: FillGoal, time: float) -> str:
    """Where a job stands at `time` [s], as JSON: what `to_fill_report` has, and what is still to come."""
    job = goal.job
    return json.dumps(
        {
            "time": time, "start": goal.start, "stage": job.stage.value, "object": job.current,
            "to_come": job.remaining, **_so_far(goal),
        }
    )  # fmt: skip


def _so_far(goal: FillGoal) -> dict[str, object]:
    """Fates of the objects that were handled, and the fill after each."""
    report = goal.job.report
    return {
        "objects": [row.row() for row in report.objects],
        "fills": [[time, fill.base_area, fill.volume] for time, fill in report.fills],
    }


def _fill(goal: FillGoal) -> Fill:
    fills = goal.job.report.fills
    return fills[-1][1] if fills else Fill(0.0, 0.0)
