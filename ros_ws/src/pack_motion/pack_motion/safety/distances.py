"""Distances between boxes, by MuJoCo: exact, where gaps along separating axes are lower bounds that jump."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.rotations import Array

FARTHEST = 100.0
"""Distances are computed up to this one [m]."""


class BoxDistances:
    """Computes the distances of k boxes from m others.

    Args:
        half: half edge lengths of the first `(k, 3)` [m].
        others: half edge lengths of the others `(m, 3)` [m].
    """

    def __init__(self, half: Array, others: Array) -> None:
        spec = mujoco.MjSpec()
        for size in (*half, *others):
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=size)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._k, self.others = len(half), others

    def between(self, R: Array, p: Array, others_R: Array, others_p: Array) -> Array:
        """Distances `(k, m)` [m]; negative where two boxes overlap.

        Args:
            R: orientations of the first boxes `(k, 3, 3)`.
            p: their centres `(k, 3)` [m].
            others_R: orientations of the others `(m, 3, 3)`.
            others_p: their centres `(m, 3)` [m].
        """
        model, data, k = self._model, self._data, self._k
        data.geom_xmat[:] = np.concatenate([R, others_R]).reshape(-1, 9)
        data.geom_xpos[:] = np.concatenate([p, others_p])
        pairs = [
            mujoco.mj_geomDistance(model, data, i, k + j, FARTHEST, None)
            for i in range(k)
            for j in range(len(others_p))
        ]
        return np.array(pairs).reshape(k, -1)
