"""`pack goal palletizing`: one order's pallet built by a running cell."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pack_bringup.cli.domain_option import Domain
from pack_bringup.cli.goal_run import Reset, run_goal
from pack_bringup.cli.network_option import Network
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


def goal(
    order: OrderFile = None,
    seed: Seed = 0,
    profile: ProfileName = "",
    reset: Reset = True,
    domain: Domain = None,
    network: Network = "",
) -> None:
    """Have a running cell build the pallet of one order.

    The exit code is 0 if every box was placed, 1 if not, and 2 if the goal was refused. Ctrl-C cancels the
    goal.

    - `pack goal palletizing --order config/orders/order_16.json`
    - `pack goal palletizing --profile thesis --domain 7`
    """
    from pack_bringup.palletizing.goal import PalletizingGoal

    wanted = PalletizingGoal(checked_order(order, profile), seed, profile)
    run_goal(wanted, reset=reset, domain=domain, network=network)


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
