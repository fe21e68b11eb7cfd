"""What a benchmark shows while it runs: a bar, and a line a trial."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.progress import TimeRemainingColumn as Remaining

if TYPE_CHECKING:
    from pack_lockstep.benchmarking.benchmark import Verdict


class TrialProgress:
    """A bar over all trials, which begins with those that are there already, and a line a trial."""

    def __init__(self, total: int, done: int = 0) -> None:
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self._bar = Progress(*columns, Remaining(), console=Console())
        self._task = self._bar.add_task("trials", total=total, completed=done)
        if done > 0:
            self._bar.console.print(f"{done} of {total} trials are there already")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def add(self, trial: Verdict) -> None:
        """Show a trial that has ended."""
        mark = "[green]ok[/]    " if trial.success else "[red]failed[/]"
        line = f"{escape(trial.name):12} {mark} {escape(trial.text)}"
        self._bar.console.print(line, highlight=False, soft_wrap=True)
        self._bar.advance(self._task)
