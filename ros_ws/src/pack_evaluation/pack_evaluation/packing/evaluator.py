"""Evaluation of a packing goal."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from pack_core.errors import PackError
from pack_evaluation.evaluator import Evaluation, Evaluator, OnProgress, WriteReplay
from pack_evaluation.html import embedded, render
from pack_evaluation.packing.fill.evaluator import FILL_EVALUATOR
from pack_evaluation.packing.fill.recording import has_fill_job
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import PackingMeasures, measure, object_displacements
from pack_evaluation.packing.plots import write_plots
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.settled_samples import write_settled_samples
from pack_evaluation.packing.video import write_still, write_video
from pack_evaluation.record import about_the_run

TEMPLATE = Path(__file__).with_name("report.html.j2")
SETTLED_SAMPLES = "settled_samples.png"
"""Name of the picture of settled samples among the plots; it has a section of its own."""


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


@dataclass(frozen=True)
class ObjectRow:
    """A line of the report's table of objects."""

    name: str
    shape: str
    size: str
    mass: float
    moved: str


def packing_page(found: Evaluation[Run, PackingMeasures]) -> str:
    """The report of an evaluated goal."""
    run, record = found.run, found.record
    files = {name: _yaml(content) for name, content in record.get("configuration", {}).items()}
    return render(
        TEMPLATE, title=f"Packing run {found.report.parent.name}", measures=found.measures, rows=found.rows,
        message=run.outcome.get("message", ""), is_cut=run.is_cut, damaged=run.damaged, notes=run.notes,
        plots=[(plot.stem, embedded(plot)) for plot in found.plots if plot.name != SETTLED_SAMPLES],
        samples=[embedded(plot) for plot in found.plots if plot.name == SETTLED_SAMPLES],
        video=embedded(found.video) if found.video else "", replay=found.replay.name if found.replay else "",
        objects=_object_rows(run), record=about_the_run(record), files=files,
    )  # fmt: skip


def _object_rows(run: Run) -> list[ObjectRow]:
    moved = object_displacements(run)
    return [
        ObjectRow(
            item.name, item.shape, " x ".join(f"{200 * half:.1f}" for half in item.half_extents), item.mass,
            f"{100 * moved[item.name]:.1f}" if item.name in moved else "packed",
        )
        for item in (*run.scene.objects, run.scene.new_object)
    ]  # fmt: skip


def _yaml(content: Any) -> str:
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
