"""What can be chosen for an order."""

from __future__ import annotations

from typing import Any

from pack_interfaces.action import Palletize
from pack_interfaces.srv import ResetCell

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order_file import parse_order
from pack_core.paths import config_path
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_viewer.ros.run_form import FileChoice, FileKind, RunForm
from pallet_fsm.states import PROFILES

CONFIGURED = "as configured"
FIRST = "order_03"
"""Two boxes: the order of the demo."""


class PalletizingRunForm(RunForm):
    """Order, seed and profile."""

    def add(self) -> None:
        """Add the widgets."""
        files = sorted(config_path("orders").glob("*.json"), key=lambda file: file.stem != FIRST)
        self._order = FileChoice(self, FileKind(
            "order", {file.stem: file for file in files},
            lambda text, name: parse_order(text, name, cell=palletizing_cell()),
        ))  # fmt: skip
        self._seed = self.gui.add_number("seed", 0, min=0, max=2**31 - 1, step=1)
        self._profile = self.gui.add_dropdown("profile", (CONFIGURED, *PROFILES))

    def reset(self) -> tuple[Contract, Any]:
        """An empty cell, and the seed of where boxes arrive."""
        return contracts.RESET, ResetCell.Request(seed=int(self._seed.value))

    def goal(self) -> tuple[Contract, Any]:
        """The order's text and the profile."""
        profile = "" if self._profile.value == CONFIGURED else self._profile.value
        return contracts.PALLETIZE, Palletize.Goal(order=self._order.text, profile=profile)


RUN_FORM = PalletizingRunForm
"""For the register of cells."""
