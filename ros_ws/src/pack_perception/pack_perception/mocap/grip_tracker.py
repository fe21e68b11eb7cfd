"""Estimates how the new object hangs on the cup, and whether it is still held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Pose, angle_between, conjugate, exp, log, multiply


class GripConfig(Config):
    """Gain of the grip estimate, and the bounds within which an object counts as held."""

    gain: float = Field(default=0.1, gt=0, le=1, description="share of a frame's difference that is believed")
    max_offset: PositiveFloat = Field(default=0.02, description="from where it was gripped [m]")
    max_angle_deg: PositiveFloat = Field(default=20.0, description="from how it was gripped [deg]")
    patience: PositiveFloat = Field(default=0.2, description="how long it must be beyond them [s]")


@dataclass
class GripTracker:
    """Estimates X_TN, the pose of the new object N on the cup T, from measured poses.

    Attributes:
        config: gain and bounds.
        nominal: X_TN at the time of gripping.
        is_held: False once measured poses were beyond the bounds around `nominal` for `config.patience` [s].
        X_TN: the current estimate.
    """

    config: GripConfig
    nominal: Pose
    is_held: bool = True

    def __post_init__(self) -> None:
        self.X_TN = self.nominal
        self._off_since: float | None = None

    def correct(self, seen: Pose, time: float) -> None:
        """Update the estimate with X_TN as measured in a frame exposed at `time` [s]."""
        if self._is_off(seen):
            self._off_since = time if self._off_since is None else self._off_since
            self.is_held = time - self._off_since < self.config.patience
            return
        self._off_since = None
        gain, now = self.config.gain, self.X_TN
        # first-order filter on position and rotation
        turn = gain * log(multiply(seen.q, conjugate(now.q)))
        self.X_TN = Pose(now.p + gain * (seen.p - now.p), multiply(exp(turn), now.q))

    def _is_off(self, seen: Pose) -> bool:
        offset = np.linalg.norm(seen.p - self.nominal.p)
        angle = angle_between(self.nominal.q, seen.q)
        return bool(offset > self.config.max_offset or angle > np.deg2rad(self.config.max_angle_deg))
