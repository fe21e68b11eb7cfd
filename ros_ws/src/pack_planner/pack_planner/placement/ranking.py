"""Order in which sampled placements are considered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pack_core.rotations import Array


def cheapest_elsewhere(
    costs: Array, poses: Array, avoid: Sequence[npt.ArrayLike], radius: float
) -> npt.NDArray[np.int_]:
    """Indices of the poses `(n, 7)` that are near none of the points `avoid`, the cheapest first.

    Near means within `radius` [m], as seen from above. If all poses are near one, the farthest is returned.
    """
    if not len(avoid):
        return np.argsort(costs, kind="stable")
    tried = np.asarray(avoid, dtype=float)[:, :2]
    distances = np.linalg.norm(poses[:, None, :2] - tried[None], axis=-1).min(axis=1)
    elsewhere = np.flatnonzero(distances >= radius)
    if not len(elsewhere):
        return np.array([np.argmax(distances)])
    return elsewhere[np.argsort(costs[elsewhere], kind="stable")]


def spread_out(ranked: npt.NDArray[np.int_], poses: Array, spacing: float, n: int) -> list[int]:
    """At most `n` of the indices `ranked`, reordered in layers so that neighbours come late.

    The first layer has the poses of `(S, 7)` that keep a distance of `spacing` [m], as seen from above, from
    every better one in the same layer. The next layer is made of the remaining poses likewise, and so on.
    """
    chosen: list[int] = []
    rest = ranked.tolist()
    while rest and len(chosen) < n:
        layer, rest = _layer(rest, poses[:, :2], spacing)
        chosen += layer
    return chosen[:n]


def _layer(ranked: Sequence[int], points: Array, spacing: float) -> tuple[list[int], list[int]]:
    """The indices that keep `spacing` from all better ones in the layer, and the remaining ones."""
    layer: list[int] = []
    rest: list[int] = []
    for k in ranked:
        is_near = len(layer) and np.linalg.norm(points[layer] - points[k], axis=1).min() <= spacing
        (rest if is_near else layer).append(k)
    return layer, rest
