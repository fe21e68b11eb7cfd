"""Evaluation of a packing goal."""

from __future__ import annotations

from pathlib import Path

from pack_core.evaluation.arrays import load_run
from pack_core.evaluation.evaluation import Evaluation, Evaluator, Progress
from pack_core.evaluation.metrics import Measures, measure
from pack_core.evaluation.plots import write_plots
from pack_core.evaluation.report import packing_page
from pack_core.evaluation.run import Run
from pack_core.evaluation.table import Row, table_rows
from pack_core.evaluation.video import write_still, write_video


class PackingEvaluator(Evaluator[Run, Measures]):
    """Of the packing cell."""

    def load(self, path: Path) -> Run:
        """The goal in a recording."""
        return load_run(path)

    def measure(self, run: Run) -> Measures:
        """Its measures."""
        return measure(run)

    def rows(self, measures: Measures) -> tuple[Row, ...]:
        """The measures in words."""
        return table_rows(measures)

    def draw(self, run: Run, folder: Path) -> list[Path]:
        """Write the plots."""
        return write_plots(run, folder)

    def film(self, run: Run, path: Path, progress: Progress) -> None:
        """Render the run as MP4."""
        write_video(run, path, progress=progress)

    def page(self, found: Evaluation[Run, Measures]) -> str:
        """The report."""
        return packing_page(found)

    def still(self, run: Run, path: Path) -> None:
        """Write one large picture of the moment the object is half way down."""
        write_still(run, path)
