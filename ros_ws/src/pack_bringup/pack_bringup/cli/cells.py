"""`pack demo CELL`, `pack goal CELL`, `pack benchmark CELL`: what every cell can be asked for."""

from __future__ import annotations

import typer

from pack_bringup.cli.motion import motion
from pack_bringup.robustness.commands import faults, hands
from pack_bringup.robustness.live_command import live
from pack_core.cells import CELLS, cell_part

app = typer.Typer()
demos = typer.Typer(
    no_args_is_help=True,
    help="Run a cell's main job: start all its nodes, pursue one goal, record it and write a report.",
)
goals = typer.Typer(
    no_args_is_help=True,
    help="Send a goal to a cell that is running (`pack up CELL`), and follow it to its end.",
)
benchmarks = typer.Typer(
    no_args_is_help=True,
    help="Measure many runs of a cell without ROS, on simulated time; or a running cell, in real time or "
    "under faults. Results are kept in a folder.",
)
for group, name in ((demos, "demo"), (goals, "goal"), (benchmarks, "benchmark")):
    app.add_typer(group, name=name)
    for cell in CELLS:
        group.command(cell)(cell_part(cell, name))


@benchmarks.callback()
def _watch() -> None:
    """Note what the command uses of the project from here on: its results depend on it."""
    from pack_core.used_files import watch

    watch()


benchmarks.command("live")(live)
benchmarks.command("faults")(faults)
benchmarks.command("hands")(hands)
benchmarks.command("motion")(motion)
