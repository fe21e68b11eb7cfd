"""The report of a run: one HTML file that needs nothing beside it."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from jinja2 import Environment, StrictUndefined

from pack_core.evaluation.metrics import Measures, object_displacements
from pack_core.evaluation.run import Run
from pack_core.evaluation.table import table_rows

TEMPLATE = Path(__file__).with_name("report.html.j2")
RECORD = "run.yaml"


@dataclass(frozen=True)
class ObjectRow:
    """A line of the report's table of objects."""

    name: str
    shape: str
    size: str
    mass: float
    moved: str


def write_report(
    run: Run, measures: Measures, path: Path, *, plots: list[Path], video: Path | None, record: dict[str, Any]
) -> None:
    """Write the report.

    Args:
        run: what is reported.
        measures: of the run.
        path: the HTML file to write.
        plots: PNG files to embed.
        video: MP4 file to embed, if any.
        record: what run.yaml holds; may be empty.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    about = {key: value for key, value in record.items() if key != "configuration"}
    about["versions"] = ", ".join(f"{name} {number}" for name, number in record.get("versions", {}).items())
    files = {name: _yaml(content) for name, content in record.get("configuration", {}).items()}
    text = environment.from_string(TEMPLATE.read_text()).render(
        title=f"Packing run {path.parent.name}", measures=measures, rows=table_rows(measures),
        message=run.outcome.get("message", ""), is_cut=run.is_cut,
        plots=[(plot.stem, _embed(plot)) for plot in plots], video=_embed(video) if video else "",
        objects=_object_rows(run), record=about if record else {}, files=files,
    )  # fmt: skip
    path.write_text(text)


def load_record(folder: Path) -> dict[str, Any]:
    """What `run.yaml` in the run's folder holds; empty where there is none."""
    path = folder / RECORD
    return dict(yaml.safe_load(path.read_text())) if path.is_file() else {}


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


def _embed(path: Path) -> str:
    return b64encode(path.read_bytes()).decode()
