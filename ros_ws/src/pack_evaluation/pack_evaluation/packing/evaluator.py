"""Evaluation of a packing goal."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from pack_core.errors import PackError
from pack_evaluation.evaluator import Evaluation, Evaluator, OnProgress, WriteReplay
from pack_evaluation.packing.fill.evaluator import FILL_EVALUATOR
from pack_evaluation.packing.fill.recording import has_fill_job
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import PackingMeasures, measure
from pack_evaluation.packing.plots import write_plots
from pack_evaluation.packing.report import SETTLED_SAMPLES, packing_page
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.settled_samples import write_settled_samples
from pack_evaluation.packing.video import write_still, write_video


class PackingEvaluator(Evaluator[Run, PackingMeasures]):
    """Evaluates a packing goal of a recording."""

    def evaluate(
        self, path: Path, output: Path, *, with_video: bool = True, progress: OnProgress = lambda _: None,
        write_replay: WriteReplay | None = None, goal: int | None = None,
    ) -> Evaluation[Any, Any]:  # fmt: skip
        """As every evaluator's; a recording that holds a fill job is evaluated as one, without a replay."""
        if goal is None and has_fill_job(path):
            return FILL_EVALUATOR.evaluate(path, output, with_video=with_video, progress=progress)
        return super().evaluate(
            path, output, with_video=with_video, progress=progress, write_replay=write_replay, goal=goal
        )

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
