"""`pack demo palletizing`: one order's pallet built before your eyes."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.demo_options import Domain, Output, RealTimeFactor, Video
from pack_bringup.cli.live import command_line, run_live
from pack_bringup.cli.page_options import PORT, Live, Port, page_process
from pack_bringup.palletizing.goal_command import OrderFile, ProfileName, Seed, checked_order
from pack_bringup.recording.run_record import default_folder


def demo(
    order: OrderFile = None,
    seed: Seed = 0,
    profile: ProfileName = "",
    visitors: Annotated[
        str,
        typer.Option(help="Who comes near the arm: a file of config/visitors, or `random`. Default: nobody."),
    ] = "",
    preset: Annotated[
        str,
        typer.Option(
            help="What the cell is like (docs/cells/palletizing/presets.md). Default: the ideal one."
        ),
    ] = "",
    calibration: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Calibration of the cell; `pack calibrate palletizing` makes it."),
    ] = None,
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    live: Live = False,
    port: Port = PORT,
    output: Output = None,
    domain: Domain = None,
) -> None:
    """Build the pallet of one order: six nodes, one goal, and a report at the end.

    The run's folder then holds the recording (bag/), report.html, plots/, run.mp4, the configuration and the
    nodes' log. The exit code is 0 only if every box was placed.

    - `pack demo palletizing --order config/orders/order_16.json`
    - `pack demo palletizing --profile thesis --no-video`
    - `pack demo palletizing --visitors person --live`
    - `pack demo palletizing --preset real --seed 3 --calibration /tmp/cell3/calibration.yaml`
    """
    from pack_bringup.palletizing.job import PalletizingJob
    from pack_sim.palletizing.crossings import visitors_of

    file = checked_order(order, profile)
    visitors_of(visitors, seed)
    folder = output or default_folder("palletizing", seed, datetime.now())
    job = PalletizingJob(
        file, seed, profile, folder=folder, real_time_factor=real_time_factor, command=command_line(),
        visitors=visitors, preset=preset, calibration=calibration,
    )  # fmt: skip
    run_live(job, video=video, domain=domain, page=page_process("palletizing", live, port))
