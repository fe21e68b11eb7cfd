"""Evaluation of a packing goal."""

from __future__ import annotations

from pathlib import Path

from pack_evaluation.evaluator import Evaluation, Evaluator, Progress
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.metrics import Measures, measure
from pack_evaluation.packing.plots import write_plots
from pack_evaluation.packing.report import packing_page
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.table import table_rows
from pack_evaluation.packing.video import write_still, write_video
from pack_evaluation.table import Row


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


EVALUATOR = PackingEvaluator()
