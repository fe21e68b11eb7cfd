"""Tables and notices for a terminal of any width, with colours or without (the variable NO_COLOR)."""

from __future__ import annotations

import os
from collections.abc import Sequence

import typer
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pack_core.text.shown import printable

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
