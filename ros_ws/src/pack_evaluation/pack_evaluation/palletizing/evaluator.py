"""Evaluation of an order of the palletizing cell."""

from __future__ import annotations

from typing import Any

from pack_evaluation.evaluator import Evaluation, Evaluator
from pack_evaluation.palletizing.from_bag import load_pallet_run
from pack_evaluation.palletizing.measures import OrderMeasures, measure_order
from pack_evaluation.palletizing.plots import write_plots
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.palletizing.video import SPEED, write_video


def report(found: Evaluation[PalletRun, OrderMeasures]) -> dict[str, Any]:
    """What the report says of an order."""
    measures = found.measures
    return {
        "title": f"Order {found.run.order}", "success": measures.is_complete,
        "verdict": f"{measures.reward} of {len(measures.boxes)} boxes in place", "message": found.run.reason,
    }  # fmt: skip


EVALUATOR = Evaluator(
    load_pallet_run, measure_order, write_plots, write_video, "palletizing/report.html.j2", report, SPEED
)
