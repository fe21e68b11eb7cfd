"""`pack benchmark blocks`: rearrangement problems, planned and carried out, as a table."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from pack_bringup.cli.benchmarks.progress import TrialProgress

SPREADS = {
    "first_plan_ms": "first plan [ms]",
    "actions": "actions",
    "lower_bound": "no plan has fewer actions than",
    "pushes": "pushes among them",
    "travel_m": "travel of the gripper [m]",
    "error_mm": "farthest block from its goal [mm]",
    "angle_deg": "most turned block [deg]",
    "disturbance_mm": "bystander moved [mm]",
    "slip_mm": "slip in the hand [mm]",
    "slip_deg": "turn in the hand [deg]",
    "duration_s": "simulated time [s]",
}


def benchmark(
    blocks: Annotated[int, typer.Option(min=1, max=25, help="How many.")] = 9,
    density: Annotated[float, typer.Option(min=0.01, max=0.6, help="Share of the area they cover.")] = 0.2,
    instances: Annotated[int, typer.Option(min=1, help="How many, with seeds from --seed on.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Of the first instance.")] = 0,
    method: Annotated[
        list[str] | None, typer.Option(help="beam (default) or pirs; may be repeated to compare.")
    ] = None,
    budget: Annotated[float, typer.Option(min=0.01, help="Of a plan [s].")] = 1.0,
    execute: Annotated[bool, typer.Option("--execute", help="Carry them out by the arm.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Instances at a time, each a process.")] = 1,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Of the results, a line an instance and method."),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the summary there.")
    ] = None,
) -> None:
    """Plan random rearrangements, check every plan by other code, and carry them out where asked to.

    Results are kept as they come: the same command goes on where it was interrupted. Executions run
    without ROS on simulated time, with pictures, and repeat bit for bit; planning times are this machine's.

    - `pack benchmark blocks --blocks 16 --density 0.2 --instances 100 --json summary.json`
    - `pack benchmark blocks --blocks 9 --method beam --method pirs`
    - `pack benchmark blocks --blocks 4 --instances 100 --execute`
    """
    from pack_bringup.benchmarking.pools import open_pool
    from pack_bringup.blocks.benchmark import PlanJob, Setup, kept_lines, run_jobs, summarize
    from pack_bringup.blocks.settings import default_output, lockstep_config
    from pack_core.cells.blocks import blocks_cell
    from pack_planner.rearrangement.planner import checked_method

    methods = [checked_method(name) for name in method or ["beam"]]
    wanted = [
        PlanJob(name, blocks, density, number) for number in range(seed, seed + instances) for name in methods
    ]
    setup = Setup(blocks_cell(), lockstep_config(), budget, execute)
    path = output or default_output(budget, with_execution=execute)
    done = len(kept_lines(path, wanted)) if path.is_file() else 0
    with open_pool(jobs, None, 1) as pool, TrialProgress(len(wanted), done) as bar:
        for line in run_jobs(path, setup, wanted, pool):
            bar.add(line["name"], _went_well(line), describe(line))
    lines = kept_lines(path, wanted)
    summaries = {name: summarize([line for line in lines if line["method"] == name]) for name in methods}
    for name, summary in summaries.items():
        Console().print(table(name, summary))
    typer.echo(f"results: {path}")
    if json_file:
        result = summaries if len(methods) > 1 else summaries[methods[0]]
        json_file.write_text(json.dumps(result, indent=2) + "\n")


def describe(line: dict[str, Any]) -> str:
    """A trial as a line."""
    text = f"{line['status']:10} {line['actions']:3} actions, bound {line['lower_bound']:3}"
    if done := line["execution"]:
        text += (
            f"  {done['exit_reason']}: {done['error_mm']:.2f} mm {done['angle_deg']:.2f} deg, bystanders "
            f"{done['disturbance_mm']:.2f} mm, slip {done['slip_mm']:.2f} mm, {done['duration_s']:.0f} s"
        )
    return "; ".join([text, *line["faults"]])


def table(method: str, summary: dict[str, Any]) -> Table:
    """The summary, a row a measure."""
    heading = (
        f"{method}: {summary['solved']} of {summary['instances']} solved, {summary['verified']} verified, "
        f"{summary['at_lower_bound']} at the lower bound"
    )
    if summary["executed"]:
        heading += f"; {summary['executed_ok']} of {summary['executed']} carried out well"
    view = Table("measure", "mean", "95th percentile", "largest", title=heading)
    for key, name in SPREADS.items():
        cells = [_number(summary[key][part]) for part in ("mean", "p95", "max")]
        if any(cells):
            view.add_row(name.replace("[", r"\["), *cells)
    return view


def _went_well(line: dict[str, Any]) -> bool:
    done = line["execution"]
    return line["is_solved"] and not line["faults"] and (done is None or done["is_ok"])


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"
