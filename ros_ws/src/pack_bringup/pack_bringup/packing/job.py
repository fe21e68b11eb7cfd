"""The job of the packing cell: one object packed."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.demo import Progress, recorder_parameters
from pack_bringup.graph.graph import preset_overrides
from pack_core.config import merged

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class PackingJob:
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/, run.yaml and scene.yaml go there.
        seed: of the generated scene, the sensors' noise and the placement planner.
        scene: a scene file; None: a generated scene.
        method: pack_it_in, uninformed_pose or uninformed_physics.
        real_time_factor: None: that of config/nodes/packing/sim.yaml.
        command: the command line, for run.yaml.
        preset: of config/presets; empty: the configuration files as they are.
    """

    folder: Path
    seed: int = 0
    scene: Path | None = None
    method: str = "pack_it_in"
    real_time_factor: float | None = None
    command: str = ""
    preset: str = ""
    cell: str = "packing"
    server: str = "mpc"

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed)}
        if self.scene is not None:
            sim["scene"] = json.dumps(str(self.scene.resolve()))
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        recorder = recorder_parameters(self, self.seed, self.command)
        return merged(preset_overrides(self.cell, self.preset), {"sim": sim, "recorder": recorder})

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import PackObject

        from pack_core.ros.contracts.packing import PACK_OBJECT

        return PACK_OBJECT, PackObject.Goal(method=self.method, seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            feedback.stage,
            f"{feedback.stage:9} {feedback.elapsed:5.1f} s   distance {100 * feedback.distance:5.1f} cm   "
            f"iteration {feedback.iteration_ms:5.0f} ms   real-time factor {real_time_factor:4.2f}",
        )
