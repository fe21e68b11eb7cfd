"""The job of the blocks cell: one rearrangement carried out."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.demo import Progress, recorder_parameters
from pack_evaluation.blocks.from_bag import PROBLEM_FILE

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class BlocksJob:
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/, run.yaml and problem.yaml go there.
        problem: a problem file's text.
        seed: of the problem, where it was generated, and of the planner.
        method: name of the planner; empty: that of config/nodes/blocks/rearrangement.yaml.
        real_time_factor: None: that of config/nodes/blocks/sim.yaml.
        command: the command line, for run.yaml.
    """

    folder: Path
    problem: str
    seed: int = 0
    method: str = ""
    real_time_factor: float | None = None
    command: str = ""
    cell: str = "blocks"
    server: str = "fsm"

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text; the problem is written for the simulator to read."""
        self.folder.mkdir(parents=True, exist_ok=True)
        file = self.folder / PROBLEM_FILE
        file.write_text(self.problem)
        sim = {"problem": json.dumps(str(file.resolve()))}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        return {"sim": sim, "recorder": recorder_parameters(self, self.seed, self.command)}

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Rearrange

        from pack_core.ros.contracts.blocks import REARRANGE

        return REARRANGE, Rearrange.Goal(problem=self.problem, method=self.method, seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        action = f"action {feedback.done + 1:2} of {feedback.actions:2}" if feedback.actions else ""
        return Progress(
            f"{feedback.phase} {feedback.block}",
            f"{feedback.phase:9} {feedback.block:4} {action:18} {feedback.elapsed:6.1f} s   "
            f"real-time factor {real_time_factor:4.2f}",
        )
