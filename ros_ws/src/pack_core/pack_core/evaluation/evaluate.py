"""From a recording to its measures, plots, video and report; the one way that every command takes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pack_core.evaluation.arrays import load_run
from pack_core.evaluation.metrics import Measures, measure
from pack_core.evaluation.plots import write_plots
from pack_core.evaluation.report import load_record, write_report
from pack_core.evaluation.run import Run
from pack_core.evaluation.table import Row, table_rows
from pack_core.evaluation.video import Progress, write_video

VIDEO, REPORT, PLOTS = "run.mp4", "report.html", "plots"


@dataclass(frozen=True)
class Evaluation:
    """What an evaluation found and wrote; `video` is None where none was wanted."""

    run: Run
    measures: Measures
    report: Path
    video: Path | None

    @property
    def rows(self) -> tuple[Row, ...]:
        """The measures in words."""
        return table_rows(self.measures)

    @property
    def is_cut(self) -> bool:
        """Whether the recording was cut off."""
        return self.run.is_cut

    def to_json(self) -> dict[str, Any]:
        """The measures as plain values, NaN as None."""
        values = {**asdict(self.measures), "exit_reason": self.measures.exit_reason.value}
        values = {name: None if value != value else value for name, value in values.items()}
        return {**values, "is_cut": self.run.is_cut}


def evaluate(
    path: Path, output: Path, *, with_video: bool = True, progress: Progress = lambda _: None
) -> Evaluation:
    """Measure a recording and write its report.

    Args:
        path: a run's folder, a bag's folder or an MCAP file.
        output: the folder for report.html, plots/ and run.mp4.
        with_video: render the run.
        progress: is told the fraction of the video done.

    Raises:
        BagError: the recording is missing, broken, or holds no goal.
        PackError: the video was wanted and there is no OpenGL to draw with.
    """
    run = load_run(path)
    measures = measure(run)
    output.mkdir(parents=True, exist_ok=True)
    video = output / VIDEO if with_video else None
    if video:
        write_video(run, video, progress=progress)
    record = load_record(path) or load_record(path.parent)
    report = output / REPORT
    plots = write_plots(run, output / PLOTS)
    write_report(run, measures, report, plots=plots, video=video, record=record)
    return Evaluation(run, measures, report, video)
