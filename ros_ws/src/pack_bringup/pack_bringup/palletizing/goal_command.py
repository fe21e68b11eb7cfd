"""`pack goal palletizing`: one order's pallet built by a running cell, or the cell calibrated."""

from __future__ import annotations

from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from pack_bringup.cli.domain_option import Domain
from pack_bringup.cli.goal_run import Reset, run_goal
from pack_bringup.cli.network_option import Network
from pack_bringup.cli.output_folder import make_output_folder
from pack_core.errors import ConfigError
from pack_core.paths import config_path

OrderFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Order to build. Default: config/orders/order_03.json."),
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of where each box arrives on the picking table.")]
ProfileName = Annotated[
    str,
    typer.Option(help="`blended` moves through; `thesis` stops at each state. Default: that of fsm.yaml."),
]
Calibrate = Annotated[
    bool, typer.Option("--calibrate", help="Find out where everything in the cell is, instead of an order.")
]
Check = Annotated[
    bool, typer.Option("--check", help="Test the calibration that the cell was started with, instead.")
]
Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="With --calibrate: takes calibration.yaml and plots."),
]


def goal(
    order: OrderFile = None,
    seed: Seed = 0,
    profile: ProfileName = "",
    calibrate: Calibrate = False,
    check: Check = False,
    output: Output = None,
    reset: Reset = True,
    domain: Domain = None,
    network: Network = "",
) -> None:
    """Have a running cell build the pallet of one order, or calibrate itself.

    The exit code is 0 if every box was placed, 1 if not, and 2 if the goal was refused. Ctrl-C cancels the
    goal.

    - `pack goal palletizing --order config/orders/order_16.json`
    - `pack goal palletizing --profile thesis --domain 7`
    - `pack goal palletizing --calibrate --output /tmp/cell3`, of a cell under `--preset real`
    - `pack goal palletizing --check`, of a cell that was started with `--calibration FILE`
    """
    from pack_bringup.palletizing.goal import PalletizingGoal

    if calibrate or check:
        _refuse_beside(order, profile, calibrate=calibrate, check=check)
        _calibrate(check, output, seed, reset=reset, domain=domain, network=network)
    wanted = PalletizingGoal(checked_order(order, profile), seed, profile)
    run_goal(wanted, reset=reset, domain=domain, network=network)


def _calibrate(
    check: bool, output: Path | None, seed: int, *, reset: bool, domain: int | None, network: str
) -> NoReturn:
    """Calibrate the cell, or test its calibration, and leave as `run_goal` does."""
    from pack_bringup.palletizing.calibration_goal import CellCalibrationGoal
    from pack_bringup.palletizing.calibration_result import show_action_result
    from pack_core.paths import bags_path

    folder = output or bags_path() / "calibrations" / f"palletizing_{datetime.now():%Y%m%d_%H%M%S}"
    if not check:
        make_output_folder(folder)
    wanted = CellCalibrationGoal(check, seed)
    show = partial(show_action_result, folder=folder)
    run_goal(wanted, reset=reset, domain=domain, network=network, show=show)


def _refuse_beside(order: Path | None, profile: str, *, calibrate: bool, check: bool) -> None:
    """Raise ConfigError for options of which only one can be."""
    given = {"--calibrate": calibrate, "--check": check, "--order": order, "--profile": profile}
    if len(names := [name for name, value in given.items() if value]) > 1:
        raise ConfigError(f"{' beside '.join(names)}; allowed: one of them")


def checked_order(order: Path | None, profile: str) -> Path:
    """The order's file, once it and the profile were found to be possible; raises PackError."""
    from pack_core.palletizing.cell import palletizing_cell
    from pack_core.palletizing.orders.order_file import load_order
    from pallet_fsm.profile import profile_of

    file = order or config_path("orders", "order_03.json")
    load_order(file, palletizing_cell())
    if profile:
        profile_of(profile)
    return file
