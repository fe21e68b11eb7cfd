"""The report of a packing goal."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from pack_evaluation.evaluator import Evaluation
from pack_evaluation.html import embedded, render
from pack_evaluation.packing.measures import PackingMeasures, object_displacements
from pack_evaluation.packing.run import Run
from pack_evaluation.record import about_the_run

TEMPLATE = Path(__file__).with_name("report.html.j2")
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
