"""A look at objects that nobody described: images in, a scene with shapes, sizes and poses out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import cv2
import numpy as np
import shapely
from pydantic import Field

from pack_core.camera import PinholeCamera
from pack_core.config import Config
from pack_core.packing.depth import DepthFrame, points_of
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import colour_of
from pack_core.rotations import Array
from pack_perception.depth.height_map import (
    HeightMap,
    HeightMapConfig,
    Mask,
    halves,
    height_map,
    is_flat,
    regions,
)
from pack_perception.depth.shape_fit import (
    FittedShape,
    ShapeFitConfig,
    candidates,
    overlap,
    seen_region,
    worth,
)

GAP = 7
"""Size of the square by which a top is widened to meet another one across a gap of unseen cells [cells]."""


class DepthLookConfig(Config):
    """How a look finds objects."""

    heights: HeightMapConfig = HeightMapConfig()
    shapes: ShapeFitConfig = ShapeFitConfig()
    gain: float = Field(
        default=0.01,
        ge=0,
        description="by which two parts must overlap better with a region to be two objects",
    )
    good: float = Field(default=0.985, gt=0, le=1, description="overlap from which a region is one object")


def scene_points(
    frames: Sequence[DepthFrame], cameras: Sequence[PinholeCamera], ceiling: float, every: int = 1
) -> Array:
    """Points `(n, 3)` [m] of frames between the table and a height [m], of one pixel in `every` each way."""
    points = np.concatenate(
        [points_of(cameras[i], frame.images[i], every) for frame in frames for i in range(len(cameras))]
    )
    return points[(points[:, 2] > -0.01) & (points[:, 2] < ceiling)]


def look_at(points: Array, container: Container, config: DepthLookConfig) -> list[FittedShape]:
    """The objects in a container.

    Args:
        points: all that was measured `(n, 3)` [m], without arm and held object.
        container: where they stand.
        config: parameters.

    Returns:
        An object for each region of tops, the largest first; their names are `seen_1` and so on.
    """
    heights = height_map(points, container, config.heights)
    found = [
        shape
        for mask in _joined(regions(heights, config.heights), points, heights, config)
        for shape in _objects_of(mask, points, heights, config)
    ]
    return [_named(f, f"seen_{i}") for i, f in enumerate(found, 1)]


def _named(fit: FittedShape, name: str) -> FittedShape:
    return replace(fit, item=fit.item.model_copy(update={"name": name, "colour": colour_of(name)}))


def _joined(masks: list[Mask], points: Array, heights: HeightMap, config: DepthLookConfig) -> list[Mask]:
    """The regions, those joined that a gap in what was seen has cut: one simple shape explains both."""
    for a, b in combinations(masks, 2):
        if not _may_be_one(a, b, heights, config):
            continue
        whole, parts = _best(a | b, points, heights, config), _all_best([a, b], points, heights, config)
        apart = overlap([(part.item, part.X_WO) for part in parts], a | b, heights)
        if whole is not None and whole.item.shape != "mesh" and whole.score >= apart - config.gain:
            rest = [mask for mask in masks if mask is not a and mask is not b]
            return _joined([a | b, *rest], points, heights, config)
    return masks


def _may_be_one(a: Mask, b: Mask, heights: HeightMap, config: DepthLookConfig) -> bool:
    """Whether two tops are flat, as high as each other, and beside each other."""
    levels = [np.nanmedian(heights.tops[mask]) for mask in (a, b)]
    if abs(levels[0] - levels[1]) > config.heights.flat or not all(
        is_flat(heights, mask, config.heights) for mask in (a, b)
    ):
        return False
    return bool(np.any(cv2.dilate(a.astype(np.uint8), np.ones((GAP, GAP), np.uint8)).astype(bool) & b))


def _objects_of(mask: Mask, points: Array, heights: HeightMap, config: DepthLookConfig) -> list[FittedShape]:
    """The object of a region, or two if they explain it better."""
    whole = _best(mask, points, heights, config)
    if whole is None:
        return []
    if whole.item.shape == "capsule" or (whole.score >= config.good and whole.item.shape != "mesh"):
        return [whole]
    first = _all_best(halves(mask, config.heights.notch / heights.cell), points, heights, config)
    if len(first) < 2:
        return [whole]
    # both parts have the cells of the cut; now each cell goes to the shape that it is nearer to
    splits = [first, _all_best(_nearer(mask, first, heights), points, heights, config)]
    scored = [(_worth_of(split, mask, heights), split) for split in splits]
    score, split = max(scored, key=lambda pair: pair[0])
    # hulls fit whatever is left of a region, so that two of them say nothing
    is_simple = any(part.item.shape != "mesh" for part in split)
    return split if is_simple and score > worth(whole) + config.gain else [whole]


def _worth_of(split: Sequence[FittedShape], mask: Mask, heights: HeightMap) -> float:
    """By which parts are compared with a whole: their overlap, less the handicap of those that are hulls."""
    handicap = np.mean([part.score - worth(part) for part in split])
    return overlap([(part.item, part.X_WO) for part in split], mask, heights) - float(handicap)


def _nearer(mask: Mask, split: Sequence[FittedShape], heights: HeightMap) -> list[Mask]:
    """The cells of a region `(nx, ny)` by the shape that they are nearest to."""
    cells = shapely.points(heights.centres(mask))
    ways = np.stack([shapely.distance(footprint(fit.item, fit.X_WO), cells) for fit in split])
    # within both outlines: by the distance from their middles, in parts of their size
    middles = np.stack([_ways_out(fit, heights.centres(mask)) for fit in split])
    owner = np.lexsort((middles, ways), axis=0)[0]
    parts = [np.zeros_like(mask) for _ in split]
    for i, part in enumerate(parts):
        part[mask] = owner == i
    return parts


def _ways_out(fit: FittedShape, centres: Array) -> Array:
    """Distances `(n,)` of points `(n, 2)` from a shape's middle, in parts of its mean half length."""
    return np.asarray(np.linalg.norm(centres - fit.X_WO.p[:2], axis=1) / fit.item.half_extents[:2].mean())


def _all_best(
    parts: Sequence[Mask], points: Array, heights: HeightMap, config: DepthLookConfig
) -> list[FittedShape]:
    """The shapes that fit the parts of a region best, without parts that are too small for an object."""
    large = [part for part in parts if part.sum() * heights.cell**2 >= config.heights.min_area]
    return [fit for part in large if (fit := _best(part, points, heights, config)) is not None]


def _best(mask: Mask, points: Array, heights: HeightMap, config: DepthLookConfig) -> FittedShape | None:
    """The shape that fits a region best; None if too little of it was seen."""
    region = seen_region(points, heights, mask, config.shapes.side)
    flat = is_flat(heights, mask, config.heights)
    return next(iter(candidates(region, heights, "seen", config.shapes, flat=flat)), None)
