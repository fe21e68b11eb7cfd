"""The goal of the blocks cell: one rearrangement carried out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pack_bringup.cell_goal import Progress

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class BlocksGoal:
    """What to rearrange, and how.

    Attributes:
        problem: a problem file's text.
        seed: of the problem, where it was generated, and of the planner.
        method: name of the planner; empty: that of config/nodes/blocks/rearrangement.yaml.
    """

    problem: str
    seed: int = 0
    method: str = ""
    cell: str = "blocks"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Rearrange

        from pack_core.ros.contracts.blocks import REARRANGE

        return REARRANGE, Rearrange.Goal(problem=self.problem, method=self.method, seed=self.seed)

    def reset(self) -> tuple[Contract, Any]:
        """The service that puts the blocks where the problem has them, and its request."""
        from pack_interfaces.srv import ResetScene

        from pack_core.ros.contracts.blocks import RESET

        return RESET, ResetScene.Request(scene=self.problem)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        action = f"action {feedback.done + 1:2} of {feedback.actions:2}" if feedback.actions else ""
        return Progress(
            f"{feedback.phase} {feedback.block}",
            f"{feedback.phase:9} {feedback.block:4} {action:18} {feedback.elapsed:6.1f} s  "
            f"real-time factor {real_time_factor:4.2f}",
        )


def seeded_goal(seed: int) -> BlocksGoal:
    """The goal of a run without choices: four blocks, generated."""
    from pack_bringup.blocks.goal_command import problem_of

    return BlocksGoal(problem_of(None, blocks=4, density=0.2, seed=seed), seed=seed)
