"""`pack calibrate`: each cell that can be calibrated adds a command of its own to `cells`."""

from __future__ import annotations

import typer

app = typer.Typer()
cells = typer.Typer(no_args_is_help=True, help="Find out where everything in a cell is, with what it has.")
app.add_typer(cells, name="calibrate")


@cells.callback()
def calibrate() -> None:
    """Calibrate a cell."""
