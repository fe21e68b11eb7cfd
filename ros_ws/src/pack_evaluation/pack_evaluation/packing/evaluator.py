"""Evaluation of a packing goal."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pack_core.errors import PackError
from pack_core.packing.seen_deviations import in_words
from pack_evaluation.evaluator import Evaluation, Evaluator
from pack_evaluation.packing.fill.evaluator import FILL_EVALUATOR
from pack_evaluation.packing.fill.recording import has_fill_job
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.measures import PackingMeasures, measure, object_displacements
from pack_evaluation.packing.plots import write_plots
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.settled_samples import write_settled_samples
from pack_evaluation.packing.video import write_still, write_video

SETTLED_SAMPLES = "settled_samples.png"
"""Name of the picture of settled samples among the plots; it has a section of its own."""


@dataclass(frozen=True)
class ObjectRow:
    """A line of the report's table of objects."""

    name: str
    shape: str
    size: str
    mass: float
    moved: str
    seen: str = ""


def draw(run: Run, folder: Path) -> list[Path]:
    """Write the plots, and the settled samples where they were recorded and OpenGL can draw them."""
    plots = write_plots(run, folder)
    if run.samples:
        samples = folder / SETTLED_SAMPLES
        with suppress(PackError):
            write_settled_samples(run, samples)
            plots.append(samples)
    return plots


def report(found: Evaluation[Run, PackingMeasures]) -> dict[str, Any]:
    """What the report says of a goal."""
    measures, message = found.measures, found.run.outcome.get("message", "")
    return {
        "title": f"Packing run {found.report.parent.name}", "success": measures.success,
        "verdict": "packed" if measures.success else "not packed",
        "message": f"{measures.exit_reason.value}: {message}" if message else measures.exit_reason.value,
        "objects": _object_rows(found.run), "has_look": found.run.seen is not None,
        "plots": [plot for plot in found.plots if plot.name != SETTLED_SAMPLES],
        "samples": next((plot for plot in found.plots if plot.name == SETTLED_SAMPLES), None),
    }  # fmt: skip


def _object_rows(run: Run) -> list[ObjectRow]:
    moved = object_displacements(run)
    return [
        ObjectRow(
            item.name, item.shape, " x ".join(f"{200 * half:.1f}" for half in item.half_extents), item.mass,
            f"{100 * moved[item.name]:.1f}" if item.name in moved else "packed", _as_seen(run, item.name),
        )
        for item in (*run.scene.objects, run.scene.new_object)
    ]  # fmt: skip


def _as_seen(run: Run, name: str) -> str:
    """What the look before the goal made of an object, in words; empty where it did not see it."""
    if run.seen is None:
        return ""
    found = run.seen.held if name == run.held else run.seen.objects.get(name)
    if found is None:
        return ""
    item = run.seen.scene.model_of(found.name)
    known = run.seen.deviations.get(item.name)
    sizes = " x ".join(f"{2000 * half:.0f}" for half in item.half_extents)
    return in_words(item, known) if known is not None else f"{sizes} mm"


EVALUATOR = Evaluator(
    load_run, measure, draw, write_video, "packing/report.html.j2", report, still=write_still,
    instead=lambda path: FILL_EVALUATOR if has_fill_job(path) else None,
)  # fmt: skip
"""Evaluates a packing goal; a recording that holds a fill job is evaluated as one, without a replay."""
