"""What became of a fill job in lockstep, as its own report has it and as it truly is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pack_core.packing.free_space import Fill
from pack_mpc.filling.fill_report import FillReport


@dataclass(frozen=True)
class FillResult:
    """A job's report, beside what is true at its end.

    Attributes:
        report: what the job itself saw.
        fill: how full the container truly is.
        inside: names of the objects that truly are in it.
        outside: names of objects that are neither in it nor where they were handed over.
        force_peak: largest external force of the whole job, behind a low-pass of 5 ms [N].
    """

    report: FillReport
    fill: Fill
    inside: tuple[str, ...]
    outside: tuple[str, ...]
    force_peak: float

    @property
    def faults(self) -> list[str]:
        """What went wrong, in words."""
        rows = [f"{row.name}: {row.reason}" for row in self.report.objects if row.has_fault]
        return rows + [f"{name} ends outside" for name in self.outside]

    def measures(self) -> dict[str, Any]:
        """Plain values for the file of results; times in [s], the force in [N], shares from 0 to 1."""
        rows = self.report.objects
        return {
            "without_fault": not self.faults, "faults": self.faults, "objects": len(self.inside),
            "given": len(rows), "base_area": self.fill.base_area, "volume": self.fill.volume,
            "durations": [row.duration for row in rows if row.name in self.inside],
            "force": self.force_peak,
            "fills": [[time, fill.base_area, fill.volume] for time, fill in self.report.fills],
        }  # fmt: skip
