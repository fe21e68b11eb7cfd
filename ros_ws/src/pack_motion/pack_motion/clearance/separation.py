"""Gaps between oriented boxes, compiled with numba.

By the separating axis theorem: Gottschalk, Lin, Manocha, "OBBTree", 1996. The largest gap along the
fifteen axes is never larger than the true distance, so that boxes found to be clear are clear.
"""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

from pack_core.kinematics import screws
from pack_core.rotations import Array

Indices = npt.NDArray[np.int64]
PARALLEL = 1e-6
"""Sine of the angle below which two edges count as parallel: their cross product gives no axis then."""


@numba.njit(cache=True)
def separation(R_a: Array, p_a: Array, half_a: Array, R_b: Array, p_b: Array, half_b: Array) -> float:
    """Largest gap [m] between two boxes along any separating axis; negative where they overlap."""
    to_b = p_b - p_a
    largest = -np.inf
    for k in range(15):  # 3 face normals of a, 3 of b, and 9 cross products of an edge of a and one of b
        if k < 3:
            axis = R_a[:, k].copy()
        elif k < 6:
            axis = R_b[:, k - 3].copy()
        else:
            axis = screws.cross(R_a[:, (k - 6) // 3].copy(), R_b[:, (k - 6) % 3].copy())
            size = np.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
            if size < PARALLEL:
                continue
            axis = axis / size
        # Distance of the centres along the axis, less half the extent of each box along it.
        gap = abs(axis[0] * to_b[0] + axis[1] * to_b[1] + axis[2] * to_b[2])
        for i in range(3):
            gap -= half_a[i] * abs(axis[0] * R_a[0, i] + axis[1] * R_a[1, i] + axis[2] * R_a[2, i])
            gap -= half_b[i] * abs(axis[0] * R_b[0, i] + axis[1] * R_b[1, i] + axis[2] * R_b[2, i])
        largest = max(largest, gap)
    return float(largest)


@numba.njit(cache=True)
def separations(
    R_links: Array, d_links: Array, link: Indices, R: Array, p: Array, half: Array, box_R: Array,
    box_p: Array, box_half: Array, enough: float,
) -> Array:  # fmt: skip
    """Gaps `(k, m)` [m] between k boxes on links and m boxes in the world; `enough` where there is more."""
    gaps = np.full((len(link), len(box_p)), enough)
    for i in range(len(link)):
        R_i = R_links[link[i]] @ R[i]
        p_i = R_links[link[i]] @ p[i] + d_links[link[i]]
        reach = np.sqrt(np.sum(half[i] ** 2)) + enough
        for j in range(len(box_p)):
            apart = np.sqrt(np.sum((box_p[j] - p_i) ** 2))
            # Circumscribed spheres farther apart than `enough`: the fifteen axes need not be tried.
            if apart > reach + np.sqrt(np.sum(box_half[j] ** 2)):
                continue
            gaps[i, j] = min(enough, separation(R_i, p_i, half[i], box_R[j], box_p[j], box_half[j]))
    return gaps


@numba.njit(cache=True)
def gaps_along(
    axes: Array, points: Array, q: Array, link: Indices, R: Array, p: Array, half: Array, box_R: Array,
    box_p: Array, box_half: Array, enough: float,
) -> Array:  # fmt: skip
    """As `separations`, for every row of joint positions `(T, n)`: `(T, k, m)`."""
    gaps = np.empty((len(q), len(link), len(box_p)))
    for t in range(len(q)):
        R_links, d_links = screws.link_transforms(axes, points, q[t])
        gaps[t] = separations(R_links, d_links, link, R, p, half, box_R, box_p, box_half, enough)
    return gaps


@numba.njit(cache=True)
def own_gaps_along(
    axes: Array, points: Array, q: Array, link: Indices, R: Array, p: Array, half: Array, pairs: Indices,
    enough: float,
) -> Array:  # fmt: skip
    """Gaps `(T, m)` [m] between pairs `(m, 2)` of boxes on links; `enough` where there is more."""
    gaps = np.full((len(q), len(pairs)), enough)
    R_now, p_now, radius = np.empty_like(R), np.empty_like(p), np.sqrt(np.sum(half**2, axis=1))
    for t in range(len(q)):
        R_links, d_links = screws.link_transforms(axes, points, q[t])
        for i in range(len(link)):
            if link[i] < 0:  # fixed to the base
                R_now[i], p_now[i] = R[i], p[i]
            else:
                R_now[i] = R_links[link[i]] @ R[i]
                p_now[i] = R_links[link[i]] @ p[i] + d_links[link[i]]
        for k in range(len(pairs)):
            i, j = pairs[k]
            apart = np.sqrt(np.sum((p_now[j] - p_now[i]) ** 2))
            if apart < radius[i] + radius[j] + enough:
                gap = separation(R_now[i], p_now[i], half[i], R_now[j], p_now[j], half[j])
                gaps[t, k] = min(enough, gap)
    return gaps
