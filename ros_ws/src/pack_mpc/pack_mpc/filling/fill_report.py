"""What became of a fill job and of each of its objects."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pack_core.packing.free_space import Fill
from pack_core.rotations import Pose


@dataclass(frozen=True)
class FilledObject:
    """One object of a list.

    Attributes:
        name: of the object.
        is_packed: whether it was let go in the container and rests there, as seen.
        reason: why not, or how it ended, in words.
        exit_reason: of the packing goal; empty if there was none.
        start: time at which it was handed over [s].
        duration: from then until the arm was free again [s].
        force_peak: largest external force on it [N].
        placements: how many placements were tried.
        X_WO: where it was seen at the end; None if it was not.
        has_fault: whether it was dropped, or a force stop ended its goal.
    """

    name: str
    is_packed: bool
    reason: str
    exit_reason: str
    start: float
    duration: float
    force_peak: float
    placements: int
    X_WO: Pose | None = None
    has_fault: bool = False

    def row(self) -> dict[str, Any]:
        """Plain values for files and tables."""
        at = None if self.X_WO is None else [*self.X_WO.p.tolist(), *self.X_WO.q.tolist()]
        return {
            "name": self.name, "packed": self.is_packed, "reason": self.reason,
            "exit_reason": self.exit_reason, "start": self.start, "duration": self.duration,
            "force_peak": self.force_peak, "placements": self.placements, "pose": at,
            "fault": self.has_fault,
        }  # fmt: skip


@dataclass
class FillReport:
    """A job's objects in the order in which they came, and the fill after each."""

    objects: list[FilledObject] = field(default_factory=list)
    fills: list[tuple[float, Fill]] = field(default_factory=list)
    message: str = ""

    @property
    def packed(self) -> list[FilledObject]:
        """The objects that rest in the container."""
        return [row for row in self.objects if row.is_packed]

    @property
    def has_fault(self) -> bool:
        """Whether an object was dropped or a force stop ended a goal."""
        return any(row.has_fault for row in self.objects)
