"""What commands show in a terminal of any width, and the signals that end them as Ctrl-C does.

Tables, notices and progress have colours, or none where the variable NO_COLOR is set.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Self

import typer
from rich.console import Console
from rich.live import Live
from rich.markup import escape
from rich.padding import Padding
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.progress import TimeRemainingColumn as Remaining
from rich.table import Table
from rich.text import Text

from pack_bringup.job import Progress as GoalProgress
from pack_core.text.shown import printable

if TYPE_CHECKING:
    from pack_lockstep.benchmarking.benchmark import Verdict

SHORT = 24
"""A cell of up to so many characters is never broken into lines."""
LEAST = 20
"""Characters a line that longer text gets at least, or its longest word."""
BORDERS = 3
"""Characters that a column takes beside its text."""

Cell = str | Text


def no_colours() -> bool:
    """Whether the environment asks for output without colours (https://no-color.org)."""
    return bool(os.environ.get("NO_COLOR"))


def notice(text: str, colour: str, *, is_error: bool = False) -> None:
    r"""Print a line in a colour, where colours are wanted and the output is a terminal.

    Control characters, which could steer the terminal, are printed as `\x1b` and the like.
    """
    typer.secho(printable(text), fg=colour, err=is_error, color=False if no_colours() else None)


def show_table(
    head: Sequence[str], rows: Sequence[Sequence[Cell]], *, title: str = "", note: str = ""
) -> None:
    """Print a table; where the terminal is too narrow for its columns, each row as a list of its cells."""
    console = Console()
    texts = [[cell if isinstance(cell, Text) else Text(printable(cell)) for cell in row] for row in rows]
    columns = [[row[k] for row in texts] for k in range(len(head))]
    needed = [_width(name, column) for name, column in zip(head, columns, strict=True)]
    if sum(needed) + BORDERS * len(needed) + 1 <= console.width:
        console.print(_as_table(head, texts, columns, title, note))
    else:
        _print_lists(console, head, texts, title, note)


def _as_table(
    head: Sequence[str], texts: list[list[Text]], columns: list[list[Text]], title: str, note: str
) -> Table:
    table = Table(title=Text(title) if title else None, caption=Text(note) if note else None)
    for name, column in zip(head, columns, strict=True):
        table.add_column(Text(_broken(name, column)), no_wrap=_is_short(column), overflow="fold")
    for row in texts:
        table.add_row(*row)
    return table


def _print_lists(
    console: Console, head: Sequence[str], texts: list[list[Text]], title: str, note: str
) -> None:
    if title:
        console.print(Text(title, style="bold"))
    for row in texts:
        console.print(row[0])
        grid = Table.grid(padding=(0, 2))
        grid.add_column(overflow="fold", max_width=max(LEAST, console.width // 3))
        grid.add_column(overflow="fold")
        for name, cell in zip(head[1:], row[1:], strict=True):
            if cell.plain:
                grid.add_row(Text(name), cell)
        console.print(Padding(grid, (0, 0, 0, 2)))
    if note:
        console.print(Text(note, style="italic"))


def _is_short(column: Sequence[Text]) -> bool:
    return all(cell.cell_len <= SHORT for cell in column)


def _broken(name: str, column: Sequence[Text]) -> str:
    """A column's head, a word a line where the cells are narrower than the head."""
    widest = max((cell.cell_len for cell in column), default=0)
    return name if len(name) <= widest else name.replace(" ", "\n")


def _width(name: str, column: Sequence[Text]) -> int:
    """Characters that a column needs."""
    words = max((len(word) for word in name.split()), default=0)
    if _is_short(column):
        return max([words, *(cell.cell_len for cell in column)])
    longest = max(len(word) for cell in column for word in cell.plain.split())
    return max(words, longest, LEAST)


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

    def show(self, progress: GoalProgress) -> None:
        """Show the newest progress."""
        if self._console.is_terminal:
            self._live.update(Text(progress.line))
        elif progress.stage != self._stage:
            self._console.print(progress.line, soft_wrap=True)
        self._stage = progress.stage


def end_as_by_ctrl_c(*numbers: signal.Signals) -> None:
    """Have these signals raise KeyboardInterrupt in the main thread, which must be the one that calls."""
    for number in numbers or (signal.SIGTERM,):
        signal.signal(number, _interrupt)


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt
