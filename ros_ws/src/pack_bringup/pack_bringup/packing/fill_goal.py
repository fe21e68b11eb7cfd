"""The other goal of the packing cell: a container filled from a list."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.cell_goal import Progress
from pack_bringup.packing.goal import PackingGoal
from pack_core.packing.cell import PackingCell
from pack_core.packing.packing_list import PackingList, load_list, parse_list, supermarket_list

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class PackingFillGoal(PackingGoal):
    """What to pack one after the other.

    Attributes:
        list_text: text of the list.
    """

    list_text: str = ""

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import FillContainer

        from pack_core.ros.contracts.packing import FILL_CONTAINER

        return FILL_CONTAINER, FillContainer.Goal(list=self.list_text, seed=self.seed)

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the container and the pump, and its request."""
        from pack_interfaces.srv import ResetScene

        from pack_core.packing.cell import packing_cell
        from pack_core.ros.contracts.packing import RESET

        cell = packing_cell()
        start = parse_list(self.list_text, "list", cell).start(cell)
        return RESET, ResetScene.Request(scene=start.to_yaml(), seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.stage} {feedback.object}",
            f"{feedback.stage:9} {feedback.object:14} {feedback.elapsed:5.1f} s  packed {feedback.packed}, "
            f"{feedback.remaining} to come, {100 * feedback.base_area:3.0f} % of the base  real-time factor "
            f"{real_time_factor:4.2f}",
        )


def wanted_list(seed: int, given: Path | None, cell: PackingCell) -> PackingList:
    """The list of a file or, without one, objects that the seed draws from the catalogue.

    Raises:
        ConfigError: the list cannot be used.
    """
    return supermarket_list(seed, cell) if given is None else load_list(given, cell)
