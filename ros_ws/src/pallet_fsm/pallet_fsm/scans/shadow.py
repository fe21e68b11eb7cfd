"""Whether arm and carried box stand between a scanner and its place."""

from __future__ import annotations

import numpy as np

from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.cell import PalletizingCell
from pack_core.robots.kr210 import WRIST_LENGTH
from pack_core.rotations import Array, Pose

_CORNERS = 0.5 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
_ALONG = np.linspace(0.0, 1.0, 65)[:, None]
"""Points of a line that are looked at: at 3 m of length they are 5 cm apart."""


class ArmShadow:
    """How far arm and carried box are from being over a place.

    A scanner hangs over the middle of its place, so that only what is over the place can hide any of it. Seen
    from above the arm is a line from its base to its wrist, as its shoulder and elbow turn in one vertical
    plane, and one from there to the pad; a carried box is a circle about the pad.

    Args:
        place: table or pallet.
        cell: the cell's physical facts.
    """

    def __init__(self, place: Obstacle, cell: PalletizingCell) -> None:
        self._X_PW, self._half = place.X_WO.inverse(), 0.5 * place.size[:2]
        self._p_WB, self._p_TH = cell.arm.X_WB.p, np.array([0.0, 0.0, -cell.tool.length - WRIST_LENGTH])

    def clearance(self, X_WT: Pose, carried: CarriedBox | None) -> float:
        """Distance of both from the place, seen from above [m]; negative where the box is over it.

        Args:
            X_WT: the measured tool.
            carried: the box in the hand, if there is one.
        """
        base, wrist, pad = self._X_PW.apply(np.array([self._p_WB, X_WT.apply(self._p_TH), X_WT.p]))[:, :2]
        arm, hand = self._distance(base, wrist), self._distance(wrist, pad)
        return min(arm, hand, self._distance(pad, pad) - _radius(X_WT, carried))

    def _distance(self, start: Array, end: Array) -> float:
        """Of a line from the place, in its own frame [m]."""
        beyond = np.maximum(np.abs(start + _ALONG * (end - start)) - self._half, 0.0)
        return float(np.linalg.norm(beyond, axis=1).min())


def _radius(X_WT: Pose, carried: CarriedBox | None) -> float:
    """Of the circle about the pad, seen from above, in which the carried box is [m]."""
    if carried is None:
        return 0.0
    corners = (X_WT @ carried.X_TB).apply(_CORNERS * carried.size)
    return float(np.linalg.norm((corners - X_WT.p)[:, :2], axis=1).max())
