"""`pack benchmark palletizing`: orders in lockstep, as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.benchmark_options import Fresh, Jobs, JsonFile, Output, Ray
from pack_bringup.cli.benchmark_run import RunOptions, run


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
    jobs: Jobs = 1,
    ray: Ray = None,
    output: Output = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Build orders without ROS on simulated time, and report how they went.

    Results repeat bit for bit, whatever the number of jobs, and are kept as they come: the same command
    goes on where it was interrupted, and --fresh measures anew.

    - `pack benchmark palletizing --seeds 5 --jobs 2 --no-vision`
    - `pack benchmark palletizing --orders config/orders --json summary.json`
    - `pack benchmark palletizing --profile thesis --no-vision`
    """
    from pack_core.paths import config_path
    from pack_lockstep.palletizing.benchmark import PalletBenchmark, order_jobs
    from pack_lockstep.palletizing.settings import set_up

    setup = set_up(profile=profile, motion=motion, preset=preset, vision=vision)
    wanted = order_jobs(orders or config_path("orders"), seeds, setup.cell)
    run(PalletBenchmark(setup, tuple(wanted)), RunOptions(jobs, ray, output, fresh, json_file))
