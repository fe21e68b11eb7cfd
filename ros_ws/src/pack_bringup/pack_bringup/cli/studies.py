"""Studies of many runs on the terminal, and their report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.console import Console

from pack_bringup.cli.terminal import notice, show_table

if TYPE_CHECKING:
    from pack_lockstep.benchmarking.side_by_side import CellStudies


def report_studies(
    cells: Sequence[CellStudies], folder: Path, *, title: str, pictures: int, videos: int = 0
) -> dict[str, dict[str, Any]]:
    """Print the tables, write the report, and say where it is.

    Args:
        cells: the studies of each cell.
        folder: for report.html, figures/ and pictures of single runs.
        title: of the report.
        pictures: single runs of each study that the report draws.
        videos: single runs of each study that are rendered whole.

    Returns:
        The summaries by cell and name of the study.
    """
    from pack_evaluation.study import summaries
    from pack_evaluation.study_report import study_section, write_study_report

    console, sections = Console(), []
    for item in cells:
        below = folder if len(cells) == 1 else folder / item.evaluator.title.lower().replace(" ", "_")
        section = study_section(
            item.evaluator, item.studies, below, pictures=pictures, videos=videos, warn=_warn
        )
        for table in section.tables:
            show_table(table.head, table.rows, title=table.title, note=table.note)
        sections.append(section)
    report = write_study_report(sections, folder, title)
    console.print(f"report: {report}", soft_wrap=True, highlight=False)
    found: dict[str, dict[str, Any]] = {}
    for item in cells:
        found.setdefault(item.cell, {}).update(summaries(item.evaluator, item.studies))
    return found


def _warn(text: str) -> None:
    notice(text, typer.colors.YELLOW, is_error=True)
