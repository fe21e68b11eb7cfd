"""`pack benchmark`: many scenes of a cell, measured."""

from __future__ import annotations

import typer

from pack_bringup.cli.benchmarks import blocks, packing, palletizing

app = typer.Typer()
cells = typer.Typer(no_args_is_help=True, help="Measure many scenes of a cell.")
app.add_typer(cells, name="benchmark")
for cell in (packing, palletizing, blocks):
    cells.command(cell.__name__.rpartition(".")[2])(cell.benchmark)
