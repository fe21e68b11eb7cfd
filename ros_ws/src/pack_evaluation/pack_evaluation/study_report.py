"""The report of many runs: one HTML file that needs nothing beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pack_core.errors import PackError
from pack_evaluation.html import render
from pack_evaluation.study import ShownRun, StudyEvaluator, StudyT
from pack_evaluation.table import TextTable

REPORT, FIGURES = "report.html", "figures"


@dataclass(frozen=True)
class StudySection:
    """A cell's part of the report.

    Attributes:
        title: its heading.
        tables: tables that compare the studies.
        figures: paths of PNG files.
        runs_title: heading of the single runs.
        runs_note: one sentence on what their pictures show.
        runs: single runs.
        about: settings and origin of each study, by its name.
    """

    title: str
    tables: Sequence[TextTable]
    figures: Sequence[Path]
    runs_title: str
    runs_note: str
    runs: Sequence[ShownRun]
    about: Mapping[str, Mapping[str, Any]]


def study_section(
    evaluator: StudyEvaluator[StudyT, Any],
    studies: Sequence[StudyT],
    folder: Path,
    *,
    pictures: int,
    videos: int = 0,
    warn: Callable[[str], None] = lambda _: None,
) -> StudySection:
    """Draw everything that a cell shows of its studies.

    Args:
        evaluator: the cell's evaluator of studies.
        studies: the studies to compare.
        folder: folder for figures/ and pictures.
        pictures: runs of each study that are drawn.
        videos: runs of each study that are rendered as MP4.
        warn: called with the reason if there are no pictures, as without OpenGL.
    """
    try:
        shown = evaluator.shown_runs(studies, folder, max(pictures, videos), videos)
    except PackError as error:
        warn(f"no pictures of single runs: {error}")
        shown = evaluator.shown_runs(studies, folder, 0, 0)
    return StudySection(
        evaluator.title, evaluator.tables(studies), evaluator.figures(studies, folder / FIGURES),
        evaluator.runs_title, evaluator.runs_note, shown,
        {study.name: about for study in studies if (about := {**study.about, **study.origin})},
    )  # fmt: skip


def write_study_report(sections: Sequence[StudySection], folder: Path, title: str) -> Path:
    """Write `report.html` into a folder and return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / REPORT
    path.write_text(render("study_report.html.j2", title=title, sections=sections, in_words=in_words))
    return path


def in_words(value: Any) -> str:
    """A setting in a table's cell: versions as `name number, name number`."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {part}" for name, part in value.items())
    return str(value)
