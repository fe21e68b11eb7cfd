"""The job of the packing cell: its nodes started, and one object packed."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from pack_bringup.demo import recorder_parameters
from pack_bringup.graph.graph import preset_overrides
from pack_bringup.packing.goal import PackingGoal
from pack_core.config import merged


@dataclass(frozen=True)
class PackingJob(PackingGoal):
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/, run.yaml and scene.yaml go there.
        real_time_factor: None: that of config/nodes/packing/sim.yaml.
        command: the command line, for run.yaml.
        preset: of config/presets; empty: the configuration files as they are.
    """

    folder: Path = field(kw_only=True)
    real_time_factor: float | None = None
    command: str = ""
    preset: str = ""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed)}
        if self.scene is not None:
            sim["scene"] = json.dumps(str(self.scene.resolve()))
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        recorder = recorder_parameters(self, self.seed, self.command)
        return merged(preset_overrides(self.cell, self.preset), {"sim": sim, "recorder": recorder})
