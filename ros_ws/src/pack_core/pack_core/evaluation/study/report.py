"""The report of one or more studies: one HTML file that needs nothing beside it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, StrictUndefined

from pack_core.evaluation.study.failures import FailurePicture
from pack_core.evaluation.study.figures import write_figures
from pack_core.evaluation.study.tables import tables
from pack_core.evaluation.study.trial import Study, Trial

TEMPLATE = Path(__file__).with_name("report.html.j2")
REPORT, FIGURES = "report.html", "figures"


@dataclass(frozen=True)
class Failure:
    """A failed trial in the report; pictures and videos are base64, empty where there is none."""

    name: str
    exit: str
    message: str
    placements: int
    picture: str = ""
    video: str = ""


def write_study_report(
    studies: Sequence[Study], folder: Path, *, title: str, pictures: Sequence[FailurePicture] = ()
) -> Path:
    """Write `report.html` and its figures into `folder` and return the report's path."""
    folder.mkdir(parents=True, exist_ok=True)
    figures = [_embed(path) for path in write_figures(studies, folder / FIGURES)]
    shown = {id(item.trial): item for item in pictures}
    failures = [_failure(trial, shown.get(id(trial))) for study in studies for trial in study.failures]
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    text = environment.from_string(TEMPLATE.read_text()).render(
        title=title, tables=tables(studies), figures=figures, failures=failures,
        about=[(study.name, study.about) for study in studies if study.about],
    )  # fmt: skip
    path = folder / REPORT
    path.write_text(text)
    return path


def _failure(trial: Trial, shown: FailurePicture | None) -> Failure:
    m = trial.measures
    picture = _embed(shown.picture) if shown else ""
    video = _embed(shown.video) if shown and shown.video else ""
    return Failure(trial.name, m.exit_reason.value, trial.message, m.placements, picture, video)


def _embed(path: Path) -> str:
    return b64encode(path.read_bytes()).decode()
