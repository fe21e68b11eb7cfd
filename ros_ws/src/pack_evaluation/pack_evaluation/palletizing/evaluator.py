"""Evaluation of an order of the palletizing cell."""

from __future__ import annotations

from pathlib import Path

from pack_evaluation.evaluator import Evaluation, Evaluator, OnProgress
from pack_evaluation.html import embedded, render
from pack_evaluation.palletizing.from_bag import load_pallet_run
from pack_evaluation.palletizing.measures import OrderMeasures, measure_order
from pack_evaluation.palletizing.plots import write_plots
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.palletizing.video import write_video
from pack_evaluation.record import about_the_run

TEMPLATE = Path(__file__).with_name("report.html.j2")


class PalletEvaluator(Evaluator[PalletRun, OrderMeasures]):
    """Evaluates an order of a recording."""

    def load(self, path: Path, goal: int | None = None) -> PalletRun:
        """An order in a recording."""
        return load_pallet_run(path, goal)

    def measure(self, run: PalletRun) -> OrderMeasures:
        """Everything that is measured of the run."""
        return measure_order(run)

    def draw(self, run: PalletRun, folder: Path) -> list[Path]:
        """Write the plots."""
        return write_plots(run, folder)

    def film(self, run: PalletRun, path: Path, progress: OnProgress) -> None:
        """Render the run as MP4."""
        write_video(run, path, progress)

    def page(self, found: Evaluation[PalletRun, OrderMeasures]) -> str:
        """The report."""
        return render(
            TEMPLATE, title=f"Order {found.run.order}", run=found.run, measures=found.measures,
            rows=found.rows, number=lambda value: "-" if value is None else f"{value:.2f}",
            record=about_the_run(found.record),
            plots=[(plot.stem, embedded(plot)) for plot in found.plots],
            video=embedded(found.video) if found.video else "",
            replay=found.replay.name if found.replay else "",
        )  # fmt: skip


EVALUATOR = PalletEvaluator()
