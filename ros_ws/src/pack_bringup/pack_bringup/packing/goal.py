"""The goal of the packing cell: one object packed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.cell_goal import Progress

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class PackingGoal:
    """What to pack, and how.

    Attributes:
        seed: of the generated scene, the sensors' noise and the placement planner.
        scene: a scene file; None: a generated scene.
        method: pack_it_in, uninformed_pose or uninformed_physics.
    """

    seed: int = 0
    scene: Path | None = None
    method: str = "pack_it_in"
    cell: str = "packing"
    server: str = "mpc"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import PackObject

        from pack_core.ros.contracts.packing import PACK_OBJECT

        return PACK_OBJECT, PackObject.Goal(method=self.method, seed=self.seed)

    def reset(self) -> tuple[Contract, Any]:
        """The service that puts the cell into the goal's scene, and its request."""
        from pack_interfaces.srv import ResetScene

        from pack_core.packing.scene_file import scene_text
        from pack_core.ros.contracts.packing import RESET

        text = "" if self.scene is None else scene_text(self.scene)
        return RESET, ResetScene.Request(scene=text, seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            feedback.stage,
            f"{feedback.stage:9} {feedback.elapsed:5.1f} s  distance {100 * feedback.distance:5.1f} cm  "
            f"MPC {feedback.iteration_ms:4.0f} ms  real-time factor {real_time_factor:4.2f}",
        )


def seeded_goal(seed: int) -> PackingGoal:
    """The goal of a run without choices: a generated scene."""
    return PackingGoal(seed=seed)
