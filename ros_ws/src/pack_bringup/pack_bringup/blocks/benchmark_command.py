"""`pack benchmark blocks`: rearrangement problems, planned and carried out, as a table."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pack_bringup.cli.live import command_line
from pack_bringup.cli.trial_progress import TrialProgress

if TYPE_CHECKING:
    from pack_evaluation.table import TextTable


def benchmark(
    blocks: Annotated[int, typer.Option(min=1, max=25, help="How many.")] = 9,
    density: Annotated[
        float, typer.Option(min=0.01, max=0.6, help="Share of the workspace's area that they cover.")
    ] = 0.2,
    instances: Annotated[int, typer.Option(min=1, help="How many, with seeds from --seed on.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Of the first instance, and of its planner.")] = 0,
    problem: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="An own instance, not generated ones; may be repeated."),
    ] = None,
    method: Annotated[
        list[str] | None, typer.Option(help="beam (default) or pirs; may be repeated to compare.")
    ] = None,
    budget: Annotated[float, typer.Option(min=0.01, help="Of a plan [s].")] = 1.0,
    execute: Annotated[bool, typer.Option("--execute", help="Carry them out by the arm.")] = False,
    jobs: Annotated[
        int, typer.Option(min=1, help="Instances at a time, each a process; with more, times grow.")
    ] = 1,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Of the results, a line an instance and method; below bags/benchmarks/ if not given.",
        ),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure anew what FILE has already.")] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the summary there.")
    ] = None,
    pictures: Annotated[int, typer.Option(min=0, help="Instances whose plans the report draws.")] = 2,
) -> None:
    """Plan rearrangements, check every plan by other code, and carry them out where asked to.

    An instance is a dense grid as goal and blocks strewn around it; the same number, density and seed give
    the same instance. With several methods all plan the same instances and are shown side by side. The
    report, beside the results, has the tables and plans drawn step by step.

    Results are kept as they come: the same command goes on where it was interrupted, and --fresh measures
    anew. Executions run without ROS on simulated time, with pictures, and repeat bit for bit; planning
    times are those of this machine.

    - `pack benchmark blocks --blocks 9 --method beam --method pirs` compares both planners
    - `pack benchmark blocks --blocks 16 --density 0.2 --instances 100 --json summary.json`
    - `pack benchmark blocks --problem config/scenarios/blocks/example.yaml` plans an own instance
    - `pack benchmark blocks --blocks 4 --instances 100 --execute` has the arm do it
    """
    from pack_core.blocks.cell import blocks_cell
    from pack_lockstep.benchmarking.pools import open_pool
    from pack_lockstep.blocks.benchmark import PlanJob, Setup, kept_lines, run_jobs
    from pack_lockstep.blocks.benchmark_instances import wanted_instances
    from pack_lockstep.blocks.benchmark_report import report_benchmark
    from pack_lockstep.blocks.benchmark_summary import comparison, summarize
    from pack_lockstep.blocks.settings import default_output, lockstep_config
    from pack_planner.rearrangement.planner import checked_method

    methods = list(dict.fromkeys(checked_method(name) for name in method or ["beam"]))
    what, found = wanted_instances(blocks, density, range(seed, seed + instances), problem or [])
    wanted = [PlanJob(name, instance) for instance in found for name in methods]
    setup = Setup(blocks_cell(), lockstep_config(), budget, execute)
    path = output or default_output(what, budget, with_execution=execute)
    if fresh:
        path.unlink(missing_ok=True)
    done = len(kept_lines(path, wanted)) if path.is_file() else 0
    with open_pool(jobs, None, 1) as pool, TrialProgress(len(wanted), done) as bar:
        for line in run_jobs(path, setup, wanted, pool):
            bar.add(line["name"], _went_well(line), describe(line))
    lines = kept_lines(path, wanted)
    summaries = {name: summarize([line for line in lines if line["method"] == name]) for name in methods}
    table = comparison(summaries, f"Blocks: {what}, {budget:g} s a plan")
    console = Console()
    console.print(_view(table))
    report = report_benchmark(path, table, wanted, lines, setup.cell, command_line(), pictures)
    console.print(f"results: {path}\nreport:  {report}", soft_wrap=True, highlight=False)
    if json_file:
        result = summaries if len(methods) > 1 else summaries[methods[0]]
        json_file.parent.mkdir(parents=True, exist_ok=True)
        json_file.write_text(json.dumps(result, indent=2) + "\n")


def describe(line: Mapping[str, Any]) -> str:
    """A trial as a line."""
    if not line["is_solved"]:
        return f"{line['status']}: {line['message']}"
    text = (
        f"{line['status']:8} {line['actions']:3} actions, bound {line['lower_bound']:3}, "
        f"first plan {line['first_plan_ms']:6.1f} ms"
    )
    if done := line["execution"]:
        text += (
            f"  {done['exit_reason']}: {done['error_mm']:.2f} mm {done['angle_deg']:.2f} deg, bystanders "
            f"{done['disturbance_mm']:.2f} mm, slip {done['slip_mm']:.2f} mm, {done['duration_s']:.0f} s"
        )
    return "; ".join([text, *line["faults"]])


def _went_well(line: Mapping[str, Any]) -> bool:
    done = line["execution"]
    return bool(line["is_solved"] and not line["faults"] and (done is None or done["is_ok"]))


def _view(table: TextTable) -> Table:
    view = Table(title=escape(table.title), caption=escape(table.note))
    for i, name in enumerate(table.head):
        view.add_column(escape(name), justify="right" if i else "left")
    for row in table.rows:
        view.add_row(*map(escape, row))
    return view
