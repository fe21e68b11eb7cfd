"""The report of one or more studies: one HTML file that needs nothing beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pack_evaluation.html import embedded, render
from pack_evaluation.packing.study.failures import FailurePicture
from pack_evaluation.packing.study.figures import write_figures
from pack_evaluation.packing.study.tables import tables
from pack_evaluation.packing.study.trial import Study, Trial

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
    figures = [embedded(path) for path in write_figures(studies, folder / FIGURES)]
    shown = {id(item.trial): item for item in pictures}
    failures = [_failure(trial, shown.get(id(trial))) for study in studies for trial in study.failures]
    text = render(
        TEMPLATE, title=title, tables=tables(studies), figures=figures, failures=failures,
        about=[(study.name, study.about) for study in studies if study.about],
    )  # fmt: skip
    path = folder / REPORT
    path.write_text(text)
    return path


def _failure(trial: Trial, shown: FailurePicture | None) -> Failure:
    m = trial.measures
    picture = embedded(shown.picture) if shown else ""
    video = embedded(shown.video) if shown and shown.video else ""
    return Failure(trial.name, m.exit_reason.value, trial.message, m.placements, picture, video)
