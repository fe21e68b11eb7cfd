"""The other goal of the palletizing cell: the cell calibrated, or its calibration tested."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pack_bringup.cell_goal import Progress
from pack_bringup.palletizing.goal import reset_of

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class CellCalibrationGoal:
    """What to do.

    Attributes:
        check: only test the calibration that the cell was started with.
        seed: of the noise; which cell it is was said when it was started.
    """

    check: bool = False
    seed: int = 0
    cell: str = "palletizing"
    server: str = "fsm"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import CalibrateCell

        from pack_core.ros.contracts.palletizing import CALIBRATE

        return CALIBRATE, CalibrateCell.Goal(check=self.check)

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the cell, and its request."""
        return reset_of(self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        from pallet_calibration.progress import CalibrationProgress, CalibrationState

        now = CalibrationProgress(
            CalibrationState(feedback.state), feedback.what, feedback.number, feedback.count,
            feedback.remaining,
        )  # fmt: skip
        return Progress(
            f"{feedback.state} {feedback.number}",
            f"{now.words}  {feedback.elapsed:6.1f} s  real-time factor {real_time_factor:4.2f}",
        )
