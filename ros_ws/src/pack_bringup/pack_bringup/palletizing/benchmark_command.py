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
            help="What the cell is like: a preset of config/cells/palletizing.yaml; `rigid` is the ideal one."
        ),
    ] = "rigid",
    vision: Annotated[
        bool,
        typer.Option(
            help="Find boxes in rendered pictures, or (--no-vision) take true poses with added noise."
        ),
    ] = True,
    limits: Annotated[
        bool,
        typer.Option(
            help="Keep the limits of joints and grip, or (--no-limits) simulate without, as the thesis does."
        ),
    ] = True,
    visitors: Annotated[
        str,
        typer.Option(
            help="Who comes near the arm: a file of config/visitors, or `random` ones, drawn from each seed."
        ),
    ] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Calibration of the cell. Default: under `real` each seed's cell is calibrated first.",
        ),
    ] = None,
    calibrate: Annotated[
        bool, typer.Option(help="Calibrate first where the preset needs it, or (--no-calibrate) do without.")
    ] = True,
    gap: Annotated[
        float | None, typer.Option(metavar="MM", min=0.0, help="Between neighbours. Default: layout.yaml's.")
    ] = None,
    first_seed: Annotated[int, typer.Option(min=0, help="The first of the seeds.")] = 0,
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
    - `pack benchmark palletizing --preset real --seeds 5`
    """
    from pack_bringup.palletizing.calibrations import calibrations_for
    from pack_core.paths import config_path
    from pack_lockstep.palletizing.benchmark import PalletBenchmark, order_files, order_jobs
    from pack_lockstep.palletizing.settings import set_up

    setup = set_up(
        profile=profile, motion=motion, preset=preset, vision=vision, visitors=visitors, gap_mm=gap,
        has_limits=limits,
    )  # fmt: skip
    files = list(dict.fromkeys(order or ())) or order_files(orders or config_path("orders"))
    wanted = order_jobs(files, seeds, setup.cell, first_seed)
    numbers = range(first_seed, first_seed + seeds)
    if calibrate or calibration is not None:
        setup = calibrations_for(setup, numbers, calibration, output, fresh=fresh)
    run(PalletBenchmark(setup, tuple(wanted)), RunOptions(jobs, ray, output, fresh, json_file))
