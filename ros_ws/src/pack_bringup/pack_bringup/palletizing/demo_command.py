"""`pack demo palletizing`: one order's pallet built before your eyes."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.demo_options import Output, RealTimeFactor, Video
from pack_bringup.cli.live import command_line, run_live
from pack_bringup.cli.page_options import PORT, Live, Port, page_process
from pack_bringup.recording.run_record import default_folder
from pack_core.paths import config_path


def demo(
    order: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Order to build. Default: config/orders/order_03.json."),
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="Seed of where each box arrives on the picking table.")
    ] = 0,
    profile: Annotated[
        str,
        typer.Option(
            help="`blended` moves through; `thesis` stops at each state. Default: that of fsm.yaml."
        ),
    ] = "",
    real_time_factor: RealTimeFactor = None,
    video: Video = True,
    live: Live = False,
    port: Port = PORT,
    output: Output = None,
) -> None:
    """Build the pallet of one order: six nodes, one goal, and a report at the end.

    The run's folder then holds the recording (bag/), report.html, plots/, run.mp4, the configuration and the
    nodes' log. The exit code is 0 only if every box was placed.

    - `pack demo palletizing --order config/orders/order_16.json`
    - `pack demo palletizing --profile thesis --no-video`
    """
    from pack_bringup.palletizing.job import PalletizingJob

    file = order or config_path("orders", "order_03.json")
    _check(file, profile)
    folder = output or default_folder("palletizing", seed, datetime.now())
    job = PalletizingJob(folder, file, seed, profile, real_time_factor, command_line())
    run_live(job, video=video, page=page_process("palletizing", live, port))


def _check(order: Path, profile: str) -> None:
    """Refuse what no node needs to be asked about."""
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import load_order
    from pallet_fsm.profile import profile_of

    load_order(order, palletizing_cell())
    if profile:
        profile_of(profile)
