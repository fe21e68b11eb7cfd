"""The job of the blocks cell: its nodes started, and one rearrangement carried out."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from pack_bringup.blocks.goal import BlocksGoal
from pack_bringup.demo import recorder_parameters
from pack_evaluation.blocks.from_bag import PROBLEM_FILE


@dataclass(frozen=True)
class BlocksJob(BlocksGoal):
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/, run.yaml and problem.yaml go there.
        real_time_factor: None: that of config/nodes/blocks/sim.yaml.
        command: the command line, for run.yaml.
    """

    folder: Path = field(kw_only=True)
    real_time_factor: float | None = None
    command: str = ""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text; the problem is written for the simulator to read."""
        self.folder.mkdir(parents=True, exist_ok=True)
        file = self.folder / PROBLEM_FILE
        file.write_text(self.problem)
        sim = {"problem": json.dumps(str(file.resolve()))}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        return {"sim": sim, "recorder": recorder_parameters(self, self.seed, self.command)}
