"""Where joint axes meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.errors import PackError
from pack_core.kinematics.chain import SerialChain
from pack_core.rotations import Array

TOLERANCE = 1e-6
"""How far the point may be from an axis that is said to pass through it [m]."""


def meeting_point(chain: SerialChain, joints: Sequence[int]) -> Array:
    """The point `(3,)` that the axes of `joints` share where all joints are zero [m].

    Raises:
        PackError: they do not meet in one point.
    """
    # x is on axis i when (I - z z') (x - r) = 0: what is across the axis vanishes. Three rows for each axis.
    across = [np.eye(3) - np.outer(chain.axes[i], chain.axes[i]) for i in joints]
    A = np.vstack(across)
    b = np.concatenate([P @ chain.points[i] for P, i in zip(across, joints, strict=True)])
    point, _, rank, _ = np.linalg.lstsq(A, b, rcond=1e-9)
    if rank < 3 or np.abs(A @ point - b).max() > TOLERANCE:
        raise PackError(f"axes {[i + 1 for i in joints]} must meet in one point for this inverse")
    return np.asarray(point)
