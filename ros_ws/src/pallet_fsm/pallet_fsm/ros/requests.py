"""Reads the order and the parameters of a goal of `/palletize`."""

from __future__ import annotations

from pathlib import Path

from pack_interfaces.action import Palletize

from pack_core.errors import OrderError
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order, parse_order
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.profile import profile_of


def requested_order(goal: Palletize.Goal, cell: PalletizingCell) -> Order:
    """The order of a goal.

    Raises:
        OrderError: the goal has no order, or the cell cannot build it; the text names every problem.
    """
    if goal.order:
        return parse_order(goal.order, "the order of the goal", cell=cell)
    if not goal.file:
        raise OrderError("the goal holds no order; give `order` or `file`")
    return load_order(Path(goal.file), cell)


def requested_config(goal: Palletize.Goal, config: PalletizerConfig) -> PalletizerConfig:
    """The node's parameters with the goal's profile; raises ConfigError where there is no such profile."""
    profile = goal.profile or config.profile
    profile_of(profile)
    return config.model_copy(update={"profile": profile})
