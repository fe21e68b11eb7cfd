"""`pack demo CELL`: a cell's main job before your eyes."""

from __future__ import annotations

import typer

from pack_core.cells import CELLS, cell_part

app = typer.Typer()
demos = typer.Typer(
    no_args_is_help=True,
    help="Run a cell's main job: start all its nodes, pursue one goal, record it and write a report.",
)
app.add_typer(demos, name="demo")
for cell in CELLS:
    demos.command(cell)(cell_part(cell, "demo"))
