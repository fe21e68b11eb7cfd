"""Evaluation of a packing goal."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from pack_core.errors import PackError
from pack_evaluation.evaluator import Evaluation, Evaluator, OnProgress
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import PackingMeasures, measure
from pack_evaluation.packing.plots import write_plots
from pack_evaluation.packing.report import SETTLED_SAMPLES, packing_page
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.settled_samples import write_settled_samples
from pack_evaluation.packing.video import write_still, write_video


class PackingEvaluator(Evaluator[Run, PackingMeasures]):
    """Evaluates a packing goal of a recording."""

    def load(self, path: Path, goal: int | None = None) -> Run:
        """A goal in a recording."""
        return load_run(path, goal)

    def measure(self, run: Run) -> PackingMeasures:
        """Everything that is measured of the run."""
        return measure(run)

    def draw(self, run: Run, folder: Path) -> list[Path]:
        """Write the plots, and the settled samples where they were recorded and OpenGL can draw them."""
        plots = write_plots(run, folder)
        if run.samples:
            samples = folder / SETTLED_SAMPLES
            with suppress(PackError):
                write_settled_samples(run, samples)
                plots.append(samples)
        return plots

    def film(self, run: Run, path: Path, progress: OnProgress) -> None:
        """Render the run as MP4."""
        write_video(run, path, progress=progress)

    def page(self, found: Evaluation[Run, PackingMeasures]) -> str:
        """The report."""
        return packing_page(found)

    def still(self, run: Run, path: Path) -> None:
        """Write one large picture of the moment the object is half way down."""
        write_still(run, path)


EVALUATOR = PackingEvaluator()
