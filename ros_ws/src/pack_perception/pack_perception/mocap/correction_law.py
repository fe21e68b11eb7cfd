"""Which share of the difference between measured and predicted poses is corrected in each frame."""

from __future__ import annotations

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array, conjugate, log, multiply
from pack_perception.mocap.alignment import Mask


class CorrectionConfig(Config):
    """Gains of the correction; low ones suffice, because physics predicts well."""

    pose_gain: float = Field(default=0.1, gt=0, le=1, description="share of an error corrected each frame")
    twist_gain: float = Field(default=0.01, ge=0, le=1, description="share of it put down to velocity")
    jump: PositiveFloat = Field(default=0.03, description="error beyond which an object is put anew [m]")
    max_period: PositiveFloat = Field(default=0.03, description="between sights that tell a velocity [s]")


def pose_errors(seen: Array, expected: Array) -> Array:
    """Translation [m] and rotation vector [rad] `(k, 6)` in world axes from `expected` to `seen` poses."""
    turns = log(multiply(seen[:, 3:], conjugate(expected[:, 3:])))
    return np.concatenate([seen[:, :3] - expected[:, :3], turns], axis=1)


def is_put_anew(errors: Array, periods: Array, config: CorrectionConfig) -> Mask:
    """Which of k objects `(k,)` are set to the measured pose: when first measured, and after a jump."""
    return np.asarray(np.isinf(periods) | (np.linalg.norm(errors[:, :3], axis=1) > config.jump))


def corrections(errors: Array, periods: Array, config: CorrectionConfig) -> tuple[Array, Array]:
    """Changes of pose and of twist `(k, 6)` that correct k objects.

    Args:
        errors: `(k, 6)`, from `pose_errors`.
        periods: time since each was last measured `(k,)` [s]; infinite the first time.
        config: the gains.
    """
    anew = is_put_anew(errors, periods, config)
    # an error that grew over a long gap says little about the velocity now
    tells_velocity = ~anew & (periods > 0.0) & (periods <= config.max_period)
    # an error that arises within one period is one of velocity, error / period; a share of it is corrected
    rates = np.where(tells_velocity, config.twist_gain, 0.0) / np.where(tells_velocity, periods, 1.0)
    return np.where(anew, 1.0, config.pose_gain)[:, None] * errors, rates[:, None] * errors
