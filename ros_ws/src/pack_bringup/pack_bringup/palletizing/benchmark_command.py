"""`pack benchmark palletizing`: orders in lockstep, as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.benchmark_options import Fresh, Jobs, JsonFile, Output, Ray
from pack_bringup.cli.benchmark_run import RunOptions, run


def benchmark(
    orders: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Build every order file of this folder. Default: config/orders."),
    ] = None,
    order: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Build the order of this file instead; may be repeated."),
    ] = None,
    seeds: Annotated[
        int, typer.Option(min=1, help="Number of runs of each order, with the seeds 0, 1, 2, ...")
    ] = 1,
    profile: Annotated[
        str, typer.Option(help="`blended` moves through; `thesis` stops and checks at each state.")
    ] = "blended",
    motion: Annotated[
        str, typer.Option(help="Parameters of the motion controller, a file of config/motion.")
    ] = "shipped",
    preset: Annotated[
        str,
        typer.Option(
            help="Preset of the arm, one of those in config/cells/palletizing.yaml; `rigid` is the ideal arm."
        ),
    ] = "rigid",
    vision: Annotated[
        bool,
        typer.Option(
            help="Find boxes in rendered pictures, or (--no-vision) take true poses with added noise."
        ),
    ] = True,
    visitors: Annotated[
        str,
        typer.Option(
            help="Who comes near the arm: a file of config/visitors, or `random` ones, drawn from each seed."
        ),
    ] = "",
    jobs: Jobs = 1,
    ray: Ray = None,
    output: Output = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Build many orders without ROS, on simulated time, and report how it went.

    Results repeat bit for bit, whatever the number of jobs, and are kept as they come: the same command
    goes on where it was interrupted, and --fresh measures anew.

    - `pack benchmark palletizing --seeds 5 --jobs 2 --no-vision`
    - `pack benchmark palletizing --order config/orders/order_03.json`
    - `pack benchmark palletizing --orders config/orders --json summary.json`
    - `pack benchmark palletizing --profile thesis --no-vision`
    - `pack benchmark palletizing --visitors random --no-vision --seeds 2`
    """
    from pack_core.paths import config_path
    from pack_lockstep.palletizing.benchmark import PalletBenchmark, order_files, order_jobs
    from pack_lockstep.palletizing.settings import set_up

    setup = set_up(profile=profile, motion=motion, preset=preset, vision=vision, visitors=visitors)
    wanted = order_jobs(
        list(dict.fromkeys(order or ())) or order_files(orders or config_path("orders")), seeds, setup.cell
    )
    run(PalletBenchmark(setup, tuple(wanted)), RunOptions(jobs, ray, output, fresh, json_file))
