"""What a cell is asked to do: its goal, the scene that belongs to it, and its progress in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class Progress:
    """What is shown while a goal is pursued: the stage it is in, and a line about it."""

    stage: str
    line: str


class CellGoal(Protocol):
    """A goal of one of the cells; pack_bringup/<cell>/goal.py has each cell's."""

    @property
    def cell(self) -> str:
        """A graph of config/graphs."""

    @property
    def server(self) -> str:
        """The node that takes the goal."""

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""

    def reset(self) -> tuple[Contract, Any]:
        """The service that puts a simulated cell into the goal's scene, and its request."""

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
