"""The job of the palletizing cell: one order's pallet built."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.demo import Progress, recorder_parameters

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class PalletizingJob:
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/ and run.yaml go there.
        order: an order's file.
        seed: of where boxes arrive.
        profile: blended or thesis; empty: that of config/nodes/palletizing/fsm.yaml.
        real_time_factor: None: that of config/nodes/palletizing/sim.yaml.
        command: the command line, for run.yaml.
    """

    folder: Path
    order: Path
    seed: int = 0
    profile: str = ""
    real_time_factor: float | None = None
    command: str = ""
    cell: str = "palletizing"
    server: str = "fsm"

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed)}
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        return {"sim": sim, "recorder": recorder_parameters(self, self.seed, self.command)}

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import Palletize

        from pack_core.ros.contracts.palletizing import PALLETIZE

        return PALLETIZE, Palletize.Goal(order=self.order.read_text(), profile=self.profile)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.box} {feedback.state}",
            f"{feedback.state:18} box {feedback.box:14} {feedback.placed:2} of {feedback.boxes:2} placed   "
            f"{feedback.elapsed:6.1f} s   real-time factor {real_time_factor:4.2f}",
        )
