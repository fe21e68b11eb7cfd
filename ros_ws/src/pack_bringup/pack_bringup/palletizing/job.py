"""The job of the palletizing cell: its nodes started, and one order's pallet built."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from pack_bringup.demo import recorder_parameters
from pack_bringup.graph.graph import conditions
from pack_bringup.palletizing.goal import PalletizingGoal
from pack_core.config import merged


@dataclass(frozen=True)
class PalletizingJob(PalletizingGoal):
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/ and run.yaml go there.
        real_time_factor: None: that of config/nodes/palletizing/sim.yaml.
        command: the command line, for run.yaml.
        visitors: who comes near the arm: a file of config/visitors, `random`, or nobody.
        preset: what the cell is like; empty: the configuration files as they are.
        calibration: its calibration file; None: none.
    """

    folder: Path = field(kw_only=True)
    real_time_factor: float | None = None
    command: str = ""
    visitors: str = ""
    preset: str = ""
    calibration: Path | None = None

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed), **({"visitors": self.visitors} if self.visitors else {})}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        recorder = recorder_parameters(self, self.seed, self.command)
        given = conditions(self.cell, self.preset, self.calibration)
        return merged(given, {"sim": sim, "recorder": recorder})
