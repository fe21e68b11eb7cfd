"""What a frame tells about the objects: whole poses where it can, their planar part where it cannot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_perception.mocap.planar_fit import PlanarFitConfig, fit_in_plane
from pack_perception.mocap.rigid_body_fit import FitConfig, Mask, Refusal, fit_rigid_bodies

TOO_LITTLE = (Refusal.TOO_FEW, Refusal.COLLINEAR)
"""What a fit in the plane may make up for; markers that do not match the object are never used."""


@dataclass(frozen=True)
class Sighting:
    """Poses of n objects; rows that were refused are not to be used.

    Attributes:
        poses: X_WB as position and quaternion `(n, 7)`.
        is_planar: which have only x, y and yaw from the markers `(n,)`.
        refusals: why the markers gave no pose, None where they did.
    """

    poses: Array
    is_planar: Mask
    refusals: tuple[Refusal | None, ...]

    @property
    def is_placed(self) -> Mask:
        """Which have a pose `(n,)`."""
        return np.array([refusal is None for refusal in self.refusals], dtype=bool)


def sight(
    p_BM: Array, p_WM: Array, visible: Mask, expected: Array, fit: FitConfig, planar: PlanarFitConfig
) -> Sighting:
    """Fit every object freely, and in the plane where its markers are too few for that.

    Args:
        p_BM: where the m markers are on each of the n objects `(n, m, 3)` [m].
        p_WM: where they were measured `(n, m, 3)` [m].
        visible: which of them were `(n, m)`.
        expected: poses `(k, 7)` of the first k objects, whose heights and tilts may be relied on.
        fit: what a free fit needs.
        planar: what a fit in the plane needs.
    """
    free = fit_rigid_bodies(p_BM, p_WM, visible, fit)
    poses, refusals = np.concatenate([free.p_WB, free.q_WB], axis=1), list(free.refusals)
    rows = [i for i in range(len(expected)) if refusals[i] in TOO_LITTLE]
    plane = fit_in_plane(p_BM[rows], p_WM[rows], visible[rows], expected[rows], planar)
    poses[rows] = np.concatenate([plane.p_WB, plane.q_WB], axis=1)
    is_planar = np.zeros(len(poses), dtype=bool)
    for i, refusal in zip(rows, plane.refusals, strict=True):
        refusals[i], is_planar[i] = refusal, refusal is None
    return Sighting(poses, is_planar, tuple(refusals))
