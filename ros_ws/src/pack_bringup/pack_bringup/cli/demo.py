"""`pack demo`: a cell's main job before your eyes."""

from __future__ import annotations

import typer

from pack_bringup.cli.demos import blocks, packing, palletizing

app = typer.Typer()
cells = typer.Typer(no_args_is_help=True, help="Run a cell's main job: all nodes, one goal, a report.")
app.add_typer(cells, name="demo")
for cell in (packing, palletizing, blocks):
    cells.command(cell.__name__.rpartition(".")[2])(cell.demo)
