"""In which order sampled placements are considered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


def cheapest_elsewhere(
    costs: Array, poses: Array, avoid: Sequence[npt.ArrayLike], radius: float
) -> npt.NDArray[np.int_]:
    """Indices of the poses `(n, 7)` near none of `avoid`, the cheapest first; if all are, of the farthest."""
    if not len(avoid):
        return np.argsort(costs, kind="stable")
    tried = np.asarray(avoid, dtype=float)[:, :2]
    distances = np.linalg.norm(poses[:, None, :2] - tried[None], axis=-1).min(axis=1)
    elsewhere = np.flatnonzero(distances >= radius)
    if not len(elsewhere):
        return np.array([np.argmax(distances)])
    return elsewhere[np.argsort(costs[elsewhere], kind="stable")]


def spread_out(ranked: npt.NDArray[np.int_], poses: Array, spacing: float, n: int) -> list[int]:
    """The first `n` of `ranked` whose poses `(S, 7)` keep `spacing` [m] from one another, seen from above."""
    chosen: list[int] = []
    for k in ranked.tolist():
        if len(chosen) == n:
            break
        if all(np.linalg.norm(poses[k, :2] - poses[other, :2]) > spacing for other in chosen):
            chosen.append(k)
    return chosen
