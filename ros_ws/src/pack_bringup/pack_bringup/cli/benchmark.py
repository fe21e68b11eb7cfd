"""`pack benchmark CELL`: many runs of a cell, measured."""

from __future__ import annotations

import typer

from pack_bringup.robustness.commands import faults, hands
from pack_core.cells import CELLS, cell_part

app = typer.Typer()
benchmarks = typer.Typer(
    no_args_is_help=True,
    help="Measure many runs of a cell without ROS, on simulated time; or a running cell, under faults. "
    "Results are kept in a folder.",
)
app.add_typer(benchmarks, name="benchmark")
for cell in CELLS:
    benchmarks.command(cell)(cell_part(cell, "benchmark"))
benchmarks.command("faults")(faults)
benchmarks.command("hands")(hands)
