"""Looks at a box a second time, on the way to it, just before the arm comes between it and the camera.

The first picture may be seconds old when the arm arrives, because the box is fed and detected ahead of time.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.ports import PalletObservation, TakePicture
from pack_core.rotations import Array, Pose, angle_between, from_yaw, multiply
from pallet_fsm.work_item import WorkItem

NEARLY_SQUARE = 0.004
"""Edges that differ by less do not tell in a picture which way round the box lies [m]."""


class SecondLookConfig(Config):
    """When the second picture is taken, and what counts as a change."""

    distance: NonNegativeFloat = Field(
        default=1.1,
        description="of the tool from the middle of table A, seen from above, at which it is taken on the "
        "way to the box; 0: never. From 0.8 m on the arm covers the table [m]",
    )
    position: PositiveFloat = Field(default=0.003, description="by which a box has moved if by more [m]")
    angle_deg: PositiveFloat = Field(default=0.6, description="by which a box has turned if by more")
    patience: PositiveFloat = Field(default=5.0, description="longest time until the camera answers [s]")


class SecondLook:
    """One look at one box at a time.

    Args:
        config: when it is taken, and what counts as a change.
        table: middle of table A `(3,)` [m].
    """

    def __init__(self, config: SecondLookConfig, table: Array) -> None:
        self._config, self._table = config, table
        self._item: WorkItem | None = None
        self._was_far = False
        self._asked: float | None = None
        self._answer: BoxDetection | None = None

    def begin(self, item: WorkItem) -> None:
        """Set off to a box that was just detected."""
        self._item, self._was_far, self._asked, self._answer = item, False, None, None

    def follow(self, seen: PalletObservation) -> TakePicture | None:
        """Take note of what is known now; the picture, once it is time for it.

        An arm that sets off from near the table has just been looked past; there is no second picture then.
        """
        item, detection = self._item, seen.detection
        if item is None:
            return None
        if self._asked is None:
            is_far = np.linalg.norm((seen.motion.X_WT.p - self._table)[:2]) > self._config.distance
            if is_far or not self._was_far:
                self._was_far |= bool(is_far)
                return None
            self._asked = seen.time
            return TakePicture(ExpectedBox(item.name, item.box.dims, seen.time))
        if detection is not None and detection.box_id == item.name and detection.time >= self._asked:
            self._answer = detection
        return None

    @property
    def is_awaited(self) -> bool:
        """Whether the picture was taken and is not answered."""
        return self._asked is not None and self._answer is None

    def change(self, time: float) -> str:
        """What is not as it was when the box was detected, in words; empty where nothing is known of."""
        if self.is_awaited:
            is_late = time > (self._asked or 0.0) + self._config.patience
            return "the camera does not answer" if is_late else ""
        if self._item is None or self._answer is None:
            return ""
        if self._answer.status is not DetectionStatus.DETECTED or self._answer.X_WB is None:
            return f"on a second look: {self._answer.reason}"
        return self._difference(self._item, self._answer.X_WB)

    def _difference(self, item: WorkItem, X_WB: Pose) -> str:
        if item.X_WB is None:
            return ""
        shift = float(np.linalg.norm(X_WB.p - item.X_WB.p))
        turn = _turn_deg(item.X_WB.q, X_WB.q, item.dims)
        if shift <= self._config.position and turn <= self._config.angle_deg:
            return ""
        return f"on a second look the box is {1e3 * shift:.0f} mm and {turn:.1f} degrees from where it was"


def _turn_deg(first: Array, second: Array, dims: Array) -> float:
    """Between two orientations of a box on a table [deg]; turns after which it looks alike count as none."""
    quarters = (0, 1, 2, 3) if abs(dims[0] - dims[1]) < NEARLY_SQUARE else (0, 2)
    alike = (multiply(second, from_yaw(n * np.pi / 2)) for n in quarters)
    return float(np.rad2deg(min(angle_between(first, q) for q in alike)))
