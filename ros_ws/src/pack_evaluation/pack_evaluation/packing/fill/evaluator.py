"""Evaluation of a recorded fill job."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from pack_evaluation.evaluator import Evaluation, Evaluator
from pack_evaluation.figures import write_figures
from pack_evaluation.packing.fill.plots import DPI, draw_fills, draw_forces
from pack_evaluation.packing.fill.recording import FillRun, load_fill_run
from pack_evaluation.packing.video import write_video
from pack_evaluation.packing.view import ViewConfig
from pack_evaluation.table import MeasureText, number, yes_or_no

VIEW = ViewConfig(lookat=(0.45, -0.15, 0.1), distance=1.25, azimuth_deg=150.0, elevation_deg=-38.0)
"""Container and hand-over place in one picture."""


@dataclass(frozen=True)
class FillMeasures:
    """What is measured of a fill job."""

    success: Annotated[
        bool, MeasureText("all packed", yes_or_no, "every object of the list is in the container")
    ]
    packed: Annotated[int, MeasureText("packed", str, "objects of the list that truly are in the container")]
    given: Annotated[int, MeasureText("given", str, "objects of the list")]
    faults: Annotated[int, MeasureText("faults", str, "objects dropped or outside, and force stops")]
    base_area: Annotated[
        float, MeasureText("base area", number("%", 1, 100.0), "share of the base that objects cover")
    ]
    volume: Annotated[
        float, MeasureText("volume", number("%", 1, 100.0), "share of the volume up to the rim")
    ]
    time_per_object: Annotated[
        float,
        MeasureText(
            "time an object", number("s"), "mean over packed objects, hand-over until the arm is free"
        ),
    ]
    force_peak: Annotated[
        float, MeasureText("peak force", number("N", 1), "largest external force, behind a 5 ms low-pass")
    ]


def measure(run: FillRun) -> FillMeasures:
    """Everything that is measured of the job, as the benchmark measures it."""
    packed, given, durations, fill = len(run.packed), len(run.given), run.durations, run.truth.fill
    return FillMeasures(
        packed == given, packed, given, len(run.faults), fill.base_area, fill.volume,
        float(np.mean(durations)) if durations else float("nan"), run.force_peak,
    )  # fmt: skip


def draw(run: FillRun, folder: Path) -> list[Path]:
    """Write the fill over time, and the force."""
    fill = draw_fills({"base area": [run.report["fills"]]})
    force = draw_forces(run.run.force_times, run.run.force)
    return write_figures({"fill": fill, "force": force}, folder, DPI)


def report(found: Evaluation[FillRun, FillMeasures]) -> dict[str, Any]:
    """What the report says of a job."""
    success = found.measures.success
    return {
        "title": f"Fill job {found.report.parent.name}", "success": success,
        "verdict": "all packed" if success else "not all packed", "message": found.run.report["message"],
    }  # fmt: skip


FILL_EVALUATOR = Evaluator(
    lambda path, goal: load_fill_run(path), measure, draw,
    lambda run, path, progress: write_video(run.run, path, progress, VIEW), "packing/fill/report.html.j2",
    report,
)  # fmt: skip
"""Evaluates the last fill job of a recording, whatever number is asked for."""
