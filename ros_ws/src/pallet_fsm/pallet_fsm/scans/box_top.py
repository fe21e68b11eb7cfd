"""The top face of a box as a scan has it: where rays cross its plane, and which tell where it ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, to_matrix
from pallet_fsm.scans.rays import Rays

STRIP = 0.024
"""Width of the strips on both sides of an edge that must be seen for the edge to tell anything [m]."""
PIECE = 0.016
"""Length of the pieces of an edge that are looked at one by one [m]."""


@dataclass(frozen=True)
class BoxTop:
    """A rectangle F: the top of a box where it is expected, axes along its edges, z up.

    Attributes:
        p_WF: its middle `(3,)` [m].
        R_WF: its axes as columns `(3, 3)`.
        half: half its edges `(2,)` [m].
    """

    p_WF: Array
    R_WF: Array
    half: Array

    @classmethod
    def of(cls, box: Obstacle) -> BoxTop:
        """The top of a box, whichever of its sides that is."""
        R_WB = to_matrix(box.X_WO.q)
        vertical = int(np.argmax(np.abs(R_WB[2])))
        level = [(vertical + 1) % 3, (vertical + 2) % 3]
        up, x = np.sign(R_WB[2, vertical]) * R_WB[:, vertical], R_WB[:, level[0]]
        R_WF = np.column_stack([x, np.cross(up, x), up])
        return cls(box.X_WO.p + 0.5 * box.size[vertical] * up, R_WF, 0.5 * box.size[level])

    def crossings(self, rays: Rays) -> tuple[Array, Array]:
        """Where rays cross its plane, along its axes `(n, 2)` [m], and at which distance `(n,)` [m]."""
        start, way = (rays.p_W - self.p_WF) @ self.R_WF, rays.directions_W @ self.R_WF
        distances = -start[2] / way[:, 2]
        return start[:2] + distances[:, None] * way[:, :2], distances

    def is_told(self, points: Array) -> Array:
        """Which of some points `(n, 2)` [m] tell where the face ends `(n,)`.

        Near an edge only those count beside which others are seen across the edge: where a neighbour hides
        the other side, the face could go on for all that is seen.
        """
        told = np.ones(len(points), dtype=bool)
        for axis in (0, 1):
            along = points[:, 1 - axis] + self.half[1 - axis]
            piece = np.floor(along / PIECE).astype(int)
            last = int(2.0 * self.half[1 - axis] / PIECE)
            for side in (-1.0, 1.0):
                depth = self.half[axis] - side * points[:, axis]
                is_beside = (np.abs(depth) < STRIP) & (piece >= 0) & (piece <= last)
                inner, outer = (
                    np.bincount(piece[is_beside & is_side], minlength=last + 1) > 0
                    for is_side in (depth > 0.0, depth <= 0.0)
                )
                told[is_beside] &= (inner & outer)[piece[is_beside]]
        return told
