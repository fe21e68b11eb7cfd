"""Whether arm and carried box stand between a scanner and its place."""

from __future__ import annotations

import numpy as np

from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose

_CORNERS = 0.5 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
_ALONG = np.linspace(0.0, 1.0, 65)[:, None]
"""Points of the line that are looked at: at 3 m of length they are 5 cm apart."""


def clearance(place: Obstacle, p_WB: Array, X_WT: Pose, carried: CarriedBox | None) -> float:
    """How far arm and carried box are from being over a place, seen from above [m]; negative over it.

    A scanner hangs over the middle of its place, so that only what is over the place can hide any of it.
    Seen from above the arm is a line from its base to its tool, as its shoulder and elbow turn in one
    vertical plane; a carried box is a circle about the tool.

    Args:
        place: table or pallet.
        p_WB: position of the arm's base `(3,)` [m].
        X_WT: the measured tool.
        carried: the box in the hand, if there is one.
    """
    ends = place.X_WO.inverse().apply(np.array([p_WB, X_WT.p]))[:, :2]
    line = ends[0] + _ALONG * (ends[1] - ends[0])
    beyond = np.maximum(np.abs(line) - 0.5 * place.size[:2], 0.0)
    return float(np.linalg.norm(beyond, axis=1).min()) - _radius(X_WT, carried)


def _radius(X_WT: Pose, carried: CarriedBox | None) -> float:
    """Of the circle about the tool, seen from above, in which the carried box is [m]."""
    if carried is None:
        return 0.0
    corners = (X_WT @ carried.X_TB).apply(_CORNERS * carried.size)
    return float(np.linalg.norm((corners - X_WT.p)[:, :2], axis=1).max())
