"""`pack benchmark packing`: many scenes in lockstep, as a table."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import track
from rich.table import Table

UNITS = {
    "execution_time_s": "execution time [s]",
    "distance_cm": "distance [cm]",
    "contact_force_N": "contact force, mean [N]",
    "peak_force_N": "contact force, peak [N]",
    "iteration_ms": "iteration [ms, this machine]",
}


def benchmark(
    scenes: Annotated[int, typer.Option(min=1, help="How many.")] = 10,
    seed: Annotated[int, typer.Option(min=0, help="Of the first scene; the next has the next seed.")] = 0,
    method: Annotated[
        str, typer.Option(help="pack_it_in, uninformed_pose or uninformed_physics.")
    ] = "pack_it_in",
    weights: Annotated[
        str | None, typer.Option(metavar="NAME", help="A set of config/weights. Default: that of the node.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the summary there, too.")
    ] = None,
) -> None:
    """Run many scenes in one process on simulated time, and say how they went.

    Everything but the iteration times repeats bit for bit on any machine: an iteration takes 48 ms of
    simulated time, whatever it takes here.

    - `pack benchmark packing --scenes 10`
    - `pack benchmark packing --method uninformed_pose --json pose.json`
    - `pack benchmark packing --weights table_1`
    """
    from pack_bringup.benchmark import run_trials, summarize
    from pack_mpc.session import Method

    chosen, seeds = Method.of(method), range(seed, seed + scenes)
    console = Console()
    trials = []
    for trial in track(run_trials(seeds, chosen, weights), "scenes", total=scenes, console=console):
        trials.append(trial)
        console.print(
            f"seed {trial.seed:4}  {trial.exit_reason:12}  {trial.execution_time_s:5.1f} s  "
            f"{trial.distance_cm:5.1f} cm  {trial.placements} placements"
        )
    summary = summarize(trials)
    console.print(table(summary))
    if output:
        output.write_text(json.dumps(summary, indent=2) + "\n")


def table(summary: dict[str, Any]) -> Table:
    """The summary, a row a measure."""
    heading = f"{summary['success']} of {summary['scenes']} packed"
    view = Table("measure", "mean", "deviation", "median", "95th percentile", title=heading)
    for key, name in UNITS.items():
        values = summary[key]
        view.add_row(escape(name), *(f"{values[part]:.2f}" for part in ("mean", "std", "median", "p95")))
    return view
