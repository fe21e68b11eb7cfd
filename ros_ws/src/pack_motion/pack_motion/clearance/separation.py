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
def separation(
    R_a: Array, p_a: Array, half_a: Array, R_b: Array, p_b: Array, half_b: Array, enough: float
) -> float:
    """Largest gap [m] between two boxes along any separating axis; negative where they overlap.

    At most `enough`: no further axis is tried once a gap is that large.
    """
    R = screws.transposed_product(R_a, R_b)  # the second box in the first one's frame
    t = screws.turned_back(R_a, p_b - p_a)
    largest = -np.inf
    for i in range(3):  # face normals of a: distance of the centres less half the extent of each box
        extent = half_b[0] * abs(R[i, 0]) + half_b[1] * abs(R[i, 1]) + half_b[2] * abs(R[i, 2])
        largest = max(largest, abs(t[i]) - half_a[i] - extent)
    for j in range(3):  # face normals of b
        extent = half_a[0] * abs(R[0, j]) + half_a[1] * abs(R[1, j]) + half_a[2] * abs(R[2, j])
        along = t[0] * R[0, j] + t[1] * R[1, j] + t[2] * R[2, j]
        largest = max(largest, abs(along) - half_b[j] - extent)
    if largest >= enough:
        return enough
    for i in range(3):  # cross products of an edge of a and one of b: a_i x b_j = (0, -R_2j, R_1j) for i = 0
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            size = np.sqrt(R[i1, j] ** 2 + R[i2, j] ** 2)
            if size < PARALLEL:
                continue
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            extent = half_a[i1] * abs(R[i2, j]) + half_a[i2] * abs(R[i1, j])
            extent += half_b[j1] * abs(R[i, j2]) + half_b[j2] * abs(R[i, j1])
            gap = (abs(t[i2] * R[i1, j] - t[i1] * R[i2, j]) - extent) / size
            largest = max(largest, gap)
    return float(min(largest, enough))


@numba.njit(cache=True)
def separations(
    R_links: Array, d_links: Array, link: Indices, R: Array, p: Array, half: Array, box_R: Array,
    box_p: Array, box_half: Array, enough: float,
) -> Array:  # fmt: skip
    """Gaps `(k, m)` [m] between k boxes on links and m boxes in the world; `enough` where there is more."""
    gaps = np.full((len(link), len(box_p)), enough)
    for i in range(len(link)):
        R_i, p_i = _moved(R_links, d_links, link[i], R[i], p[i])
        reach = np.sqrt(screws.dot(half[i], half[i])) + enough
        for j in range(len(box_p)):
            # Circumscribed spheres farther apart than `enough`: the fifteen axes need not be tried.
            apart = box_p[j] - p_i
            radii = reach + np.sqrt(screws.dot(box_half[j], box_half[j]))
            if screws.dot(apart, apart) <= radii * radii:
                gaps[i, j] = separation(R_i, p_i, half[i], box_R[j], box_p[j], box_half[j], enough)
    return gaps


@numba.njit(cache=True)
def _moved(R_links: Array, d_links: Array, link: int, R: Array, p: Array) -> tuple[Array, Array]:
    """Orientation and centre of a box now; a box with link -1 is fixed to the base."""
    if link < 0:
        return R.copy(), p.copy()
    return screws.product(R_links[link], R), screws.turned(R_links[link], p) + d_links[link]


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
            R_now[i], p_now[i] = _moved(R_links, d_links, link[i], R[i], p[i])
        for k in range(len(pairs)):
            i, j = pairs[k]
            apart = p_now[j] - p_now[i]
            radii = radius[i] + radius[j] + enough
            if screws.dot(apart, apart) < radii * radii:
                gaps[t, k] = separation(R_now[i], p_now[i], half[i], R_now[j], p_now[j], half[j], enough)
    return gaps
