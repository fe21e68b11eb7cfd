"""The goal of the palletizing cell: one order's pallet built."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.cell_goal import Progress
from pack_core.paths import config_path

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract

SMALL_ORDERS = (9, 3, 14, 15, 1, 16, 6, 17)
"""Numbers of the orders of config/orders with two to five boxes. The first one begins with a box that is
stood up on table B and so passes every state; the others are sorted by their size."""


@dataclass(frozen=True)
class PalletizingGoal:
    """What to build, and how.

    Attributes:
        order: an order's file.
        seed: of where boxes arrive.
        profile: blended or thesis; empty: that of config/nodes/palletizing/fsm.yaml.
    """

    order: Path
    seed: int = 0
    profile: str = ""
    cell: str = "palletizing"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Palletize

        from pack_core.ros.contracts.palletizing import PALLETIZE
        from pack_core.text.reader import read_text

        return PALLETIZE, Palletize.Goal(order=read_text(self.order), profile=self.profile)

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the cell, and its request."""
        return reset_of(self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.box} {feedback.state}",
            f"{feedback.state:18} {feedback.box:14} {feedback.placed:2}/{feedback.boxes}  "
            f"{feedback.elapsed:6.1f} s  real-time factor {real_time_factor:4.2f}",
        )


def reset_of(seed: int) -> tuple[Contract, Any]:
    """The service that empties the cell and brings the arm home, and its request."""
    from pack_interfaces.srv import ResetCell

    from pack_core.ros.contracts.palletizing import RESET

    return RESET, ResetCell.Request(seed=seed)


def seeded_goal(seed: int) -> PalletizingGoal:
    """The goal of a run without choices: one of the small orders of config/orders."""
    orders = [config_path("orders", f"order_{number:02}.json") for number in SMALL_ORDERS]
    return PalletizingGoal(order=orders[seed % len(orders)], seed=seed)
