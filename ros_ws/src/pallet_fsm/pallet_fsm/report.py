"""What became of an order: each box, each fault, with the reasons."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import Any

from pack_core.rotations import Pose
from pallet_fsm.machine import Visit
from pallet_fsm.states import FAULTS, State


class BoxOutcome(StrEnum):
    """What became of a box."""

    PENDING = "pending"
    PLACED = "placed"
    SKIPPED = "skipped"
    LOST = "lost"


@dataclass(frozen=True)
class BoxReport:
    """A box of the order.

    Attributes:
        name: name of the box.
        dims: edges as it arrives [m].
        mass: mass of the box as it was told [kg].
        weighed: its mass by the arm's torques after the last grip [kg]; None where it was not weighed.
        handling: none, flip or table.
        outcome: what became of the box.
        reason: why it was skipped or lost; empty otherwise.
        direction: name of the side that it was inserted from.
        X_WB: planned pose on the pallet.
    """

    name: str
    dims: tuple[float, float, float]
    mass: float
    weighed: float | None
    handling: str
    outcome: BoxOutcome
    reason: str
    direction: str
    X_WB: Pose


@dataclass(frozen=True)
class OrderReport:
    """An order that has ended.

    Attributes:
        order: id of the order.
        is_complete: whether every box was placed.
        reason: why the order stopped before its end; empty if it did not.
        boxes: report of each box, in the sequence of the plan.
        visits: every state that was entered, in order.
        X_WP: pose of the pallet as the cell is known.
    """

    order: str
    is_complete: bool
    reason: str
    boxes: tuple[BoxReport, ...]
    visits: tuple[Visit, ...]
    X_WP: Pose

    @property
    def faults(self) -> tuple[Visit, ...]:
        """The visits of fault states."""
        return tuple(visit for visit in self.visits if visit.state in FAULTS)

    def to_json(self) -> dict[str, Any]:
        """The report as plain values; poses are position and quaternion wxyz."""
        cycles = self.cycle_times()
        boxes = [
            {
                "name": box.name, "dims": list(box.dims), "mass": box.mass,
                "weighed": box.weighed, "handling": box.handling,
                "outcome": box.outcome.value, "reason": box.reason,
                "direction": box.direction, "pose": [*box.X_WB.p, *box.X_WB.q],
                "cycle_s": cycles.get(box.name),
            }
            for box in self.boxes
        ]  # fmt: skip
        return {
            "order": self.order, "is_complete": self.is_complete, "reason": self.reason, "boxes": boxes,
            "pallet": [*self.X_WP.p, *self.X_WP.q],
        }  # fmt: skip

    def cycle_times(self) -> dict[str, float]:
        """Cycle time of each placed box [s]: from its state 0 to that of the next box.

        The cycle of the last box ends with its retreat.
        """
        starts: dict[str, float] = {}
        ends: dict[str, float] = {}
        before = ""
        for visit, following in pairwise(self.visits):
            if visit.state is State.SPAWN:
                starts.setdefault(visit.box, visit.time)
                if before and visit.box != before:
                    ends[before] = visit.time
                before = visit.box
            elif visit.state is State.RETREAT:
                ends[visit.box] = following.time
        placed = {box.name for box in self.boxes if box.outcome is BoxOutcome.PLACED}
        return {name: ends[name] - starts[name] for name in starts if name in ends and name in placed}
