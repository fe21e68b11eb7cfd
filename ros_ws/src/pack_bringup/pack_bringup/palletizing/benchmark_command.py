"""`pack benchmark palletizing`: orders in lockstep, as a table."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from pack_bringup.cli.trial_progress import TrialProgress

if TYPE_CHECKING:
    from pack_evaluation.palletizing.summary import OrderTrial

SPREADS = {
    "tracking_position_mm": "tracking, position [mm]",
    "tracking_orientation_deg": "tracking, orientation [deg]",
    "goal_position_mm": "position at goals [mm]",
    "placed_error_mm": "placed box, position [mm]",
    "placed_angle_deg": "placed box, orientation [deg]",
    "shift_mm": "shift of earlier boxes [mm]",
}


def benchmark(
    orders: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of orders. Default: config/orders.")
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Runs of each order, with seeds from 0 on.")] = 1,
    profile: Annotated[
        str, typer.Option(help="blended, or thesis: stop and check at each state.")
    ] = "blended",
    motion: Annotated[str, typer.Option(help="A set of config/motion.")] = "shipped",
    preset: Annotated[
        str, typer.Option(help="Of the arm: one of config/cells/palletizing.yaml, rigid being ideal.")
    ] = "rigid",
    vision: Annotated[
        bool, typer.Option(help="Render the camera's pictures; otherwise the truth with stated noise.")
    ] = True,
    jobs: Annotated[int, typer.Option(min=1, help="Orders at a time, each a process.")] = 1,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Of the results, a line an order and seed."),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure anew what FILE has already.")] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the summary there.")
    ] = None,
) -> None:
    """Build orders without ROS on simulated time, and report how they went.

    Results repeat bit for bit, whatever the number of jobs, and are kept as they come: the same command
    goes on where it was interrupted, and --fresh measures anew.

    - `pack benchmark palletizing --seeds 5 --jobs 2 --no-vision`
    - `pack benchmark palletizing --orders config/orders --json summary.json`
    - `pack benchmark palletizing --profile thesis --no-vision`
    """
    from pack_core.paths import config_path
    from pack_evaluation.palletizing.summary import summarize_orders
    from pack_lockstep.benchmarking.pools import open_pool
    from pack_lockstep.palletizing.benchmark import kept_trials, order_jobs, run_orders
    from pack_lockstep.palletizing.settings import default_output, set_up

    setup = set_up(profile=profile, motion=motion, preset=preset, vision=vision)
    wanted = order_jobs(orders or config_path("orders"), seeds, setup.cell)
    path = output or default_output(profile=profile, motion=motion, preset=preset, vision=vision)
    if fresh:
        path.unlink(missing_ok=True)
    done = len(kept_trials(path, wanted)) if path.is_file() else 0
    with open_pool(jobs, None, 1) as pool, TrialProgress(len(wanted), done) as bar:
        for trial in run_orders(path, setup, wanted, pool):
            bar.add(f"{trial.order} seed {trial.seed}", trial.measures["is_complete"], describe(trial))
    summary = summarize_orders(kept_trials(path, wanted))
    Console().print(table(summary))
    typer.echo(f"results: {path}")
    if json_file:
        json_file.parent.mkdir(parents=True, exist_ok=True)
        json_file.write_text(json.dumps(summary, indent=2) + "\n")


def describe(trial: OrderTrial) -> str:
    """A trial as a line."""
    m = trial.measures
    errors = [box["error_mm"] for box in m["boxes"] if box["error_mm"] is not None]
    cycles = [box["cycle_s"] for box in m["boxes"] if box["cycle_s"] is not None]
    text = (
        f"{m['reward']:2} of {len(m['boxes']):2} boxes  worst {max(errors, default=0.0):5.2f} mm  "
        f"cycle {sum(cycles) / max(len(cycles), 1):5.1f} s  tracking {m['position_mm'][1]:5.2f} mm  "
        f"{m['touches']} contacts"
    )
    return "; ".join([text, *m["faults"]])


def table(summary: dict[str, Any]) -> Table:
    """The summary, a row a measure."""
    heading = (
        f"{summary['orders_complete']} of {summary['orders']} orders complete with every seed, "
        f"{summary['boxes_ok']} of {summary['boxes']} boxes in place"
    )
    view = Table("measure", "mean", "95th percentile", "largest", title=heading)
    for key, name in SPREADS.items():
        view.add_row(
            name.replace("[", r"\["), *(_number(summary[key].get(part)) for part in ("mean", "p95", "max"))
        )
    for kind in ("none_or_flip", "table", "mean", "boxes_per_hour"):
        view.add_row(f"cycle, {kind.replace('_', ' ')}", _number(summary["cycle_s"][kind]), "", "")
    hold = summary["stack_hold"]
    view.add_row("stacks that hold 0.2 g", f"{hold['held']} of {hold['tested']}", "", "")
    view.add_row("drops", str(summary["drops"]), "", "")
    view.add_row("unwanted contacts over 20 N", str(summary["unwanted_contacts"]), "", "")
    return view


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"
