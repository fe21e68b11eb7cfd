"""`pack goal CELL`: a goal for a cell that is running."""

from __future__ import annotations

import typer

from pack_core.cells import CELLS, cell_part

app = typer.Typer()
goals = typer.Typer(
    no_args_is_help=True,
    help="Send a goal to a cell that is running (`pack up CELL`), and follow it to its end.",
)
app.add_typer(goals, name="goal")
for cell in CELLS:
    goals.command(cell)(cell_part(cell, "goal"))
