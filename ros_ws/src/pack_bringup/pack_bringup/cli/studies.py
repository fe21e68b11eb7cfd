"""Studies of many runs on the terminal, and their report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from pack_core.evaluation.study.failures import FailurePicture
    from pack_core.evaluation.study.trial import Study


def report_studies(
    studies: Sequence[Study], folder: Path, *, title: str, pictures: Sequence[FailurePicture] = ()
) -> None:
    """Print the tables, write the report and say where it is."""
    from pack_core.evaluation.study.report import write_study_report
    from pack_core.evaluation.study.tables import tables

    console = Console()
    for found in tables(studies):
        view = Table(*map(escape, found.head), title=escape(found.title), caption=escape(found.note))
        for row in found.rows:
            view.add_row(*map(escape, row))
        console.print(view)
    report = write_study_report(studies, folder, title=title, pictures=pictures)
    console.print(f"report: {report}", soft_wrap=True)
