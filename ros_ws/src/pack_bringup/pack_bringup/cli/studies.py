"""Studies of many runs on the terminal, and their report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from pack_evaluation.packing.study.failures import FailurePicture
    from pack_lockstep.packing.studies import Source


def report_studies(
    sources: Sequence[Source], folder: Path, *, title: str, pictures: int, videos: int = 0
) -> None:
    """Print the tables, write the report and say where it is.

    Args:
        sources: the studies and their runs.
        folder: of report.html, figures/ and failures/.
        title: of the report.
        pictures: failures of each study whose end is drawn.
        videos: failures of each study that are rendered whole.
    """
    from pack_evaluation.packing.study.report import write_study_report
    from pack_evaluation.packing.study.tables import tables

    console, studies = Console(), [source.study for source in sources]
    for found in tables(studies):
        view = Table(title=escape(found.title), caption=escape(found.note))
        for name in found.head:
            view.add_column(escape(name), overflow="fold")
        for row in found.rows:
            view.add_row(*map(escape, row))
        console.print(view)
    shown = _draw_failures(sources, folder / "failures", max(pictures, videos), videos)
    report = write_study_report(studies, folder, title=title, pictures=shown)
    console.print(f"report: {report}", soft_wrap=True)


def _draw_failures(
    sources: Sequence[Source], folder: Path, pictures: int, videos: int
) -> list[FailurePicture]:
    """Pictures of failures; none where there is no OpenGL to draw with."""
    from pack_core.errors import PackError
    from pack_evaluation.packing.study.failures import show_failures

    shown: list[FailurePicture] = []
    for i, source in enumerate(sources):
        failed = source.study.failures[:pictures]
        try:
            if failed:
                shown += show_failures(failed, source.load, folder / str(i + 1), videos=videos)
        except PackError as error:
            typer.secho(f"no pictures of failures: {error}", fg=typer.colors.YELLOW, err=True)
            break
    return shown
