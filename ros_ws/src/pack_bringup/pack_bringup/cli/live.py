"""Runs a job before your eyes: a line that is kept up to date, then the report."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import NoReturn, Self

import typer
from rich.console import Console
from rich.live import Live
from rich.text import Text

from pack_bringup.cell_goal import Progress
from pack_bringup.cli.evaluate import evaluator_of, run_evaluation, show
from pack_bringup.cli.interrupts import end_as_by_ctrl_c
from pack_bringup.cli.network_option import prepare_network
from pack_bringup.cli.output_folder import make_output_folder
from pack_bringup.cli.terminal import notice
from pack_bringup.demo import LOG, Job, run_demo
from pack_bringup.page import PageProcess
from pack_bringup.recording.run_record import BAG_FOLDER
from pack_core.errors import BagError
from pack_evaluation.record import RECORD


def command_line() -> str:
    """As it was given."""
    return " ".join(["pack", *sys.argv[1:]])


def run_live(
    job: Job, *, video: bool, domain: int | None = None, page: PageProcess | None = None
) -> NoReturn:
    """Run a job, evaluate its recording, and leave with 0 only if it succeeded.

    Args:
        job: what to run.
        video: render the run for the report.
        domain: ROS domain id; None: the environment's, else a free one.
        page: a page that shows the run while it goes on; None: none.

    Raises:
        PackError: the folder cannot take the run, a node did not come up or died, or the goal was refused.
    """
    prepare_network()
    make_output_folder(job.folder, taken_by=(BAG_FOLDER, RECORD, LOG))
    end_as_by_ctrl_c()
    if page:
        typer.echo(page.announcement)
    try:
        with LiveLine() as line:
            result, pace = run_demo(job, line.show, domain, page)
    except KeyboardInterrupt:
        typer.echo(f"stopped; what was recorded is in {job.folder}")
        raise typer.Exit(130) from None
    reason = getattr(result, "exit_reason", "success" if result.success else "failure")
    typer.echo(f"goal ended: {reason}" + (f", {result.message}" if result.message else ""))
    try:
        found = run_evaluation(evaluator_of(job.folder), job.folder, job.folder, with_video=video)
    except KeyboardInterrupt:
        typer.echo(f"stopped before the report was written: `pack evaluate {job.folder}` writes it")
        raise typer.Exit(130) from None
    except BagError:
        if result.success:
            raise
        # A goal that fails before the arm has moved is recorded, with nothing in it to measure.
        typer.echo(f"there is no report: the goal ended before its work began\nlog:    {job.folder / LOG}")
        raise typer.Exit(1) from None
    show(found)
    typer.echo(f"log:    {job.folder / LOG}")
    if pace.warning:
        notice(pace.warning, typer.colors.YELLOW)
    raise typer.Exit(0 if result.success else 1)


class LiveLine:
    """One line that is kept up to date; where there is no terminal, a line for every stage."""

    def __init__(self) -> None:
        self._console = Console()
        self._live = Live(console=self._console, refresh_per_second=8, transient=False)
        self._stage: str | None = None

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.stop()

    def show(self, progress: Progress) -> None:
        """Show the newest progress."""
        if self._console.is_terminal:
            self._live.update(Text(progress.line))
        elif progress.stage != self._stage:
            self._console.print(progress.line, soft_wrap=True)
        self._stage = progress.stage
