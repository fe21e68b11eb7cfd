"""Evaluation of a recorded fill job."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from pack_evaluation.evaluator import Evaluation, Evaluator, OnProgress
from pack_evaluation.html import embedded, render
from pack_evaluation.packing.fill.plots import plot_fills, plot_forces
from pack_evaluation.packing.fill.recording import FillRun, load_fill_run
from pack_evaluation.packing.video import write_video
from pack_evaluation.packing.view import ViewConfig
from pack_evaluation.record import about_the_run
from pack_evaluation.table import MeasureText, number, yes_or_no

TEMPLATE = Path(__file__).with_name("report.html.j2")
VIEW = ViewConfig(lookat=(0.45, -0.15, 0.1), distance=1.25, azimuth_deg=150.0, elevation_deg=-38.0)
"""Container and hand-over place in one picture."""


@dataclass(frozen=True)
class FillMeasures:
    """What is measured of a fill job."""

    success: Annotated[
        bool, MeasureText("all packed", yes_or_no, "every object of the list is in the container")
    ]
    packed: Annotated[int, MeasureText("packed", str, "objects that truly are in the container")]
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


class FillEvaluator(Evaluator[FillRun, FillMeasures]):
    """Evaluates the last fill job of a recording."""

    def load(self, path: Path, goal: int | None = None) -> FillRun:
        """The last fill job in a recording; `goal` has no influence."""
        return load_fill_run(path)

    def measure(self, run: FillRun) -> FillMeasures:
        """Everything that is measured of the job, as the benchmark measures it."""
        packed, durations, fill = len(run.truth.inside), run.durations, run.truth.fill
        return FillMeasures(
            packed == run.given, packed, run.given, len(run.faults), fill.base_area, fill.volume,
            float(np.mean(durations)) if durations else float("nan"), run.force_peak,
        )  # fmt: skip

    def draw(self, run: FillRun, folder: Path) -> list[Path]:
        """Write the fill over time, and the force."""
        fills = plot_fills({"base area": [run.report["fills"]]}, folder)
        return [*fills, plot_forces(run.run.force_times, run.run.force, folder)]

    def film(self, run: FillRun, path: Path, progress: OnProgress) -> None:
        """Render the job as MP4."""
        write_video(run.run, path, VIEW, progress)

    def page(self, found: Evaluation[FillRun, FillMeasures]) -> str:
        """The report: measures, a row an object, plots."""
        report = found.run.report
        return render(
            TEMPLATE, title=f"Fill job {found.report.parent.name}", rows=found.rows,
            success=found.measures.success, message=report["message"], is_cut=found.run.is_cut,
            damaged=found.run.damaged, notes=found.run.notes, objects=report["objects"],
            plots=[(plot.stem, embedded(plot)) for plot in found.plots],
            video=embedded(found.video) if found.video else "", record=about_the_run(found.record),
        )  # fmt: skip


FILL_EVALUATOR = FillEvaluator()
