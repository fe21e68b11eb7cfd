"""What a fill job asks of the cell, and what it is answered."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_mpc.task.task import PackingOutcome


@dataclass(frozen=True)
class Arrange:
    """Where the remaining objects shall stand, and which comes next; answered by an `Arrangement`.

    Attributes:
        items: the remaining objects, in the list's order.
        planned: where the last arrangement had them, X_WO.
    """

    items: tuple[ObjectModel, ...]
    planned: Mapping[str, Pose]


@dataclass(frozen=True)
class Present:
    """The object is to be handed over; answered by `Presented`."""

    item: ObjectModel


@dataclass(frozen=True)
class Judge:
    """Whether the object that was handed over has a feasible placement; answered by why not, or empty."""


@dataclass(frozen=True)
class UsePump:
    """Close the pump, or open it; answered by the reason why not, empty if it is done."""

    close: bool


@dataclass(frozen=True)
class Pack:
    """Pack the held object; answered by `Packed`.

    Attributes:
        X_WN: where it is wanted; None: wherever it disturbs least.
        grip: X_TN, how it hangs from the cup.
    """

    X_WN: Pose | None
    grip: Pose


FillRequest: TypeAlias = Arrange | Present | Judge | UsePump | Pack


@dataclass(frozen=True)
class Presented:
    """The cell's description with the object handed over, or the reason why it is not."""

    scene: Scene | None
    reason: str = ""


@dataclass(frozen=True)
class Packed:
    """How a packing goal ended, and the packing pose X_WN that it pursued last; None if it had none."""

    outcome: PackingOutcome
    X_WN: Pose | None
