"""What was seen of one object: its top, what is beside it, where it is known to end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.objects import Box, Cylinder, ObjectModel
from pack_core.rotations import Array, Pose
from pack_perception.depth.height_map import HeightMap, Mask
from pack_perception.depth.sight_lines import SightLines

DIRECTIONS = np.stack([f(2.0 * np.pi * np.arange(36) / 36) for f in (np.cos, np.sin)], axis=1)
"""Directions in the plane in which a round outline is measured `(36, 2)`."""
UPRIGHT_SHARES = (0.5, 0.75, 0.95)
"""Heights at which a box or a cylinder is tried, in parts of its own; a round body only at the first."""


@dataclass(frozen=True)
class SeenRegion:
    """What was seen of one object.

    Attributes:
        mask: cells of its top `(nx, ny)`.
        top: points of its top `(n, 3)` [m].
        near: points below tops near it `(m, 3)` [m], sides of this object and of others.
        ends: in which of `DIRECTIONS` it is known to end where it was seen to `(36,)`; else it may go on.
        sight: what the cameras look onto.
    """

    mask: Mask
    top: Array
    near: Array
    ends: Mask
    sight: SightLines


def seen_region(heights: HeightMap, mask: Mask, margin: float) -> SeenRegion:
    """The points that belong to a region, and those at its edges that are lower."""
    reach = int(np.ceil(margin / heights.cell))
    wide = cv2.dilate(mask.astype(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)) > 0
    within = wide[tuple(heights.cells.T)]
    points, cells = heights.points[within], heights.cells[within]
    tops = heights.tops[tuple(cells.T)]
    is_top = mask[tuple(cells.T)] & (np.abs(points[:, 2] - tops) < margin)
    ends = _ends(heights, mask, points[is_top], margin)
    return SeenRegion(mask, points[is_top], points[~is_top], ends, heights.sight)


def _ends(heights: HeightMap, mask: Mask, top: Array, margin: float) -> Mask:
    """In which of `DIRECTIONS` something else is known to be just beyond a top's outermost points."""
    if not len(top):
        return np.zeros(len(DIRECTIONS), dtype=bool)
    outermost = top[np.argmax(top[:, :2] @ DIRECTIONS.T, axis=0)]
    beyond = [
        outermost + np.insert(way * DIRECTIONS, 2, 0.0, axis=1)
        for way in (0.5 * margin, margin, 1.5 * margin)
    ]
    return np.asarray(np.mean([heights.is_known_apart(p, mask) for p in beyond], axis=0) > 0.5)


def overlap(placed: Sequence[tuple[ObjectModel, Pose]], mask: Mask, heights: HeightMap) -> float:
    """Overlap of the outlines of objects at X_WO with a region `(nx, ny)`, intersection over union.

    Cells in which nothing was seen count neither way, as they may hide a part of an object, unless a camera
    saw through them.
    """
    outline = shapely.union_all([footprint(item, X_WO) for item, X_WO in placed])
    centres, shape = heights.centres(), heights.tops.shape
    # cells on the outline are of both sides: they count neither way
    core, wide = (
        shapely.contains_xy(outline.buffer(share * heights.cell), centres).reshape(shape)
        for share in (-0.5, 1.0)
    )
    empty, unseen = core & ~mask, np.isnan(heights.tops)
    empty[empty & unseen] = _is_seen_through(placed, heights.centres(empty & unseen), heights.sight)
    both, beyond = core & mask, mask & ~wide
    return float(both.sum() / max((both | empty | beyond).sum(), 1))


def _is_seen_through(placed: Sequence[tuple[ObjectModel, Pose]], centres: Array, sight: SightLines) -> Mask:
    """Over which of some places `(n, 2)` [m] a camera saw through what a body would have there."""
    is_free = np.zeros(len(centres), dtype=bool)
    for item, X_WO in placed:
        # bodies are widest at half of their height, or as wide as there; straight ones are up to their tops
        shares = UPRIGHT_SHARES if isinstance(item, Box | Cylinder) else UPRIGHT_SHARES[:1]
        within = shapely.contains_xy(footprint(item, X_WO), centres)
        for share in shares:
            level = 2.0 * share * X_WO.p[2]
            is_free[within] |= sight.is_free(np.insert(centres[within], 2, level, axis=1))
    return is_free
