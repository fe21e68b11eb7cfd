"""A map of the heights in the container, and the regions in it that are the tops of single objects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import cv2
import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pack_core.packing.scene import Container
from pack_core.rotations import Array
from pack_perception.depth.sight_lines import SightLines
from pack_perception.perception_config import HeightMapConfig

Mask = npt.NDArray[np.bool_]
Labels = npt.NDArray[np.int_]

EDGE = 5
"""Width of what is left beside tops and is no edge of theirs [cells]."""
FEWEST = 2
"""Points that a cell's top has at least, or so many neighbours as `SUPPORT`."""
SUPPORT = 3
"""Neighbours as high as a cell by which the only point in it is believed."""
PIECE = 0.25
"""Least size of a piece that something cut off a top, in parts of the smallest object."""
MOST_NOTCHES = 5
"""Notches between which a region is cut, the deepest ones."""
SHOULDER_SHARE = 0.4
"""Share of what was seen around a flat top from which what slopes down there belongs to it."""
STEEP_CELLS = 20
"""Most cells by which a round top goes on beyond where it gets steep: the shoulder of a bottle, 5 cm."""


@dataclass(frozen=True)
class HeightMap:
    """Heights of the tops over the container's base.

    Attributes:
        lower: the container's inner corner with the smallest x and y `(2,)` [m].
        cell: edge of a cell [m].
        tops: mean height of the top in each cell `(nx, ny)` [m]; nan where nothing was seen.
        points: what was measured between the walls `(n, 3)` [m].
        cells: the cells of these points `(n, 2)`.
        sight: what the cameras saw through.
    """

    lower: Array
    cell: float
    tops: Array
    points: Array
    cells: Labels
    sight: SightLines

    def is_known_apart(self, points: Array, mask: Mask) -> Mask:
        """Where something else than a region `(nx, ny)` is known to be, of points `(n, 3)` [m].

        Another surface was seen in the cell, a camera saw through the point, or it is not between the walls.
        """
        cells = np.floor((points[:, :2] - self.lower) / self.cell).astype(int)
        apart = np.any((cells < 0) | (cells >= self.tops.shape), axis=1)
        inside = tuple(cells[~apart].T)
        apart[~apart] = ~mask[inside] & np.isfinite(self.tops[inside])
        return np.asarray(apart | self.sight.is_free(points))

    def centres(self, mask: Mask | None = None) -> Array:
        """Centres `(n, 2)` [m] of the cells of a mask `(nx, ny)`; None: of all, row by row."""
        cells = np.argwhere(np.ones(self.tops.shape, dtype=bool) if mask is None else mask)
        return np.asarray(self.lower + (cells + 0.5) * self.cell)


def height_map(points: Array, sight: SightLines, container: Container, config: HeightMapConfig) -> HeightMap:
    """The map of points `(n, 3)` [m]; points outside of the walls are left out."""
    shape = tuple(math.ceil(side / config.cell) for side in container.size)
    cells = np.floor((points[:, :2] - container.lower) / config.cell).astype(int)
    inside = np.all((cells >= 0) & (cells < shape), axis=1)
    points, cells = points[inside], cells[inside]
    numbers, z = cells @ np.array([shape[1], 1]), points[:, 2]
    order = np.lexsort([-z, numbers])
    numbers, z = numbers[order], z[order]
    # the highest point of a cell, unless it is alone up there: then it flies between two surfaces
    first = np.flatnonzero(np.diff(numbers, prepend=-1))
    second = np.minimum(first + 1, len(z) - 1)
    flies = (numbers[second] == numbers[first]) & (z[first] - z[second] > config.flier)
    highest = np.full(math.prod(shape), np.nan)
    highest[numbers[first]] = np.where(flies, z[second], z[first])
    near = np.abs(z - highest[numbers]) <= config.flier
    count = np.bincount(numbers[near], minlength=math.prod(shape))
    total = np.bincount(numbers[near], z[near], minlength=math.prod(shape))
    with np.errstate(invalid="ignore"):
        tops = (total / count).reshape(shape)
    # where nothing is seen, single points fly: they have no neighbours
    alone = (count.reshape(shape) < FEWEST) & (_neighbours(tops, config.flier) < SUPPORT)
    return HeightMap(
        container.lower, config.cell, _without_holes(np.where(alone, np.nan, tops)), points, cells, sight
    )


def _around(tops: Array) -> Array:
    """Heights of each cell's 3 x 3 neighbours and its own `(nx, ny, 9)`; nan beyond the map."""
    padded = np.pad(tops, 1, constant_values=np.nan)
    return np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).reshape(*tops.shape, 9)


def _neighbours(tops: Array, step: float) -> Labels:
    """Number of neighbours `(nx, ny)` that are as high as a cell, but for a step [m]."""
    return np.asarray((np.abs(_around(tops) - tops[..., None]) < step).sum(axis=-1) - 1)


def _without_holes(tops: Array) -> Array:
    """Single unseen cells get the median of their neighbours, if most of these were seen."""
    around = _around(tops)
    holes = np.isnan(tops) & (np.isfinite(around).sum(axis=-1) >= 5)
    filled = tops.copy()
    filled[holes] = np.nanmedian(around[holes], axis=-1)
    return filled


def regions(heights: HeightMap, config: HeightMapConfig) -> list[Mask]:
    """Connected tops `(nx, ny)` that end where the height jumps, the largest first."""
    tops = heights.tops
    above, least = tops > config.floor, config.min_area / heights.cell**2
    joined = _connected(tops, above, config.jump, least)
    found = [part for mask in joined for part in _by_cores(mask, heights, config, least)]
    found = [_with_sides(mask, found, heights, config) for mask in found]
    # what a bridge joined to a larger top, then tops that are steep all over; edges of others are narrow
    for step in (config.jump, config.slope):
        rest = above & ~np.any([*found, ~above], axis=0)
        wide = cv2.morphologyEx(rest.astype(np.uint8), cv2.MORPH_OPEN, np.ones((EDGE, EDGE), np.uint8)) > 0
        found += _connected(tops, wide, step, 2.0 * least)
    return sorted(found, key=lambda mask: -mask.sum())


def pieces(heights: HeightMap, found: Sequence[Mask], config: HeightMapConfig) -> list[Mask]:
    """Level pieces `(nx, ny)` that are too small to be objects, as what hides a top cuts them off it."""
    rest = (heights.tops > config.floor) & ~np.any([*found, np.zeros_like(heights.tops, bool)], axis=0)
    least = config.min_area / heights.cell**2
    parts = _connected(heights.tops, rest, config.jump, PIECE * least)
    return [part for part in parts if is_flat(heights, part, config)]


def _connected(tops: Array, cells: Mask, step: float, least: float) -> list[Mask]:
    """Parts of `cells` `(nx, ny)` between whose neighbours heights differ by less than `step` [m].

    They have at least so many cells, the largest comes first, and bridges are broken.
    """
    number = np.arange(tops.size).reshape(tops.shape)
    ends = []
    for a, b in ((np.s_[1:], np.s_[:-1]), ((np.s_[:], np.s_[1:]), (np.s_[:], np.s_[:-1]))):
        joined = cells[a] & cells[b] & (np.abs(tops[a] - tops[b]) < step)
        ends.append(np.stack([number[a][joined], number[b][joined]]))
    rows, columns = np.concatenate(ends, axis=1)
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(tops.size, tops.size))
    _, labels = connected_components(graph, directed=False)
    sizes = np.bincount(labels[cells.ravel()], minlength=labels.max() + 1)
    order = np.argsort(-sizes)
    large = order[sizes[order] >= least]
    parts = [_opened((labels == i).reshape(tops.shape) & cells) for i in large]
    return [part for part in parts if part.sum() >= least]


def is_flat(heights: HeightMap, mask: Mask, config: HeightMapConfig) -> bool:
    """Whether a top is level, but for its edges."""
    low, high = np.percentile(heights.tops[mask & np.isfinite(heights.tops)], [10, 90])
    return bool(high - low < 2.0 * config.flat)


def _by_cores(mask: Mask, heights: HeightMap, config: HeightMapConfig, least: float) -> list[Mask]:
    """The tops that a region consists of: its level parts, each with the cells that are nearest to it.

    Between tops of other heights, and between round ones, there are steep cells all along.
    """
    if is_flat(heights, mask, config):
        return [mask]
    core = mask & (_steps(heights.tops, mask) < config.jump)
    cores = _connected(heights.tops, core, config.jump, least)
    if len(cores) < 2:
        return [mask]
    return [mask & near for near in _nearest(cores)]


def _nearest(masks: Sequence[Mask]) -> list[Mask]:
    """For each of some masks `(nx, ny)` the cells that are nearer to it than to the others, or its own."""
    _, labels = cv2.distanceTransformWithLabels((~np.any(masks, axis=0)).astype(np.uint8), cv2.DIST_L2, 5)
    return [np.isin(labels, np.unique(labels[mask])) for mask in masks]


def _steps(tops: Array, mask: Mask) -> Array:
    """How much heights change over two cells of a region `(nx, ny)` [m], means of three side by side."""
    values, weights = np.where(mask, tops, 0.0), mask.astype(float)
    steps = []
    for size, axis in (((1, 3), 1), ((3, 1), 0)):  # OpenCV's sizes are (along y, along x) of the map
        total, count = (
            cv2.boxFilter(x, -1, size, normalize=False, borderType=cv2.BORDER_CONSTANT)
            for x in (values, weights)
        )
        means = np.pad(
            np.where(count > 0.0, total / np.maximum(count, 1.0), np.nan), 1, constant_values=np.nan
        )
        later, earlier = (np.roll(means, way, axis=axis)[1:-1, 1:-1] for way in (-1, 1))
        steps.append(np.nan_to_num(later - earlier))
    return np.asarray(np.hypot(*steps))


def _with_sides(mask: Mask, others: list[Mask], heights: HeightMap, config: HeightMapConfig) -> Mask:
    """A top with its steep sides; a flat one with a shoulder all around, as a bottle's cap has it."""
    grown = _grown(mask, others, heights.tops, config)
    if not is_flat(heights, mask, config):
        return grown
    # next to a top lie cells of its edge; upright sides have no others
    ring = _widened(mask, 3) & ~_widened(mask, 1) & np.isfinite(heights.tops)
    return grown if np.count_nonzero(grown & ring) > SHOULDER_SHARE * np.count_nonzero(ring) else mask


def _widened(mask: Mask, cells: int) -> Mask:
    side = 2 * cells + 1
    return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)) > 0)


def _grown(mask: Mask, others: list[Mask], tops: Array, config: HeightMapConfig) -> Mask:
    """A round top with its steep edges, which no other top may have."""
    taken = (
        np.any([other for other in others if other is not mask], axis=0) if len(others) > 1 else ~mask & False
    )
    grown = mask.copy()
    for _ in range(STEEP_CELLS):
        heights = np.where(grown, tops, -np.inf)
        around = cv2.dilate(heights, np.ones((3, 3), np.uint8))
        step = around - tops
        grown |= ~taken & (tops > config.floor) & (step > 0.0) & (step < config.slope)
    return grown


def _opened(mask: Mask) -> Mask:
    """The largest part of a mask that is left when bridges of two cells are broken."""
    kernel = np.ones((3, 3), np.uint8)
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, kernel)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(opened, connectivity=4)
    if count < 2:
        return mask
    return np.asarray(labels == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA])))


def halves(mask: Mask, notch: float) -> list[Mask]:
    """The two parts of a region that is cut between two notches; none if it has no two.

    That cut is taken whose parts fill their hulls best, as what hides an object makes notches, too.

    Args:
        mask: the region `(nx, ny)`.
        notch: least depth of a notch [cells].
    """
    # an outline that passes a cell twice, over a bridge of one, has no hull to OpenCV
    mask = _opened(mask)
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    outline = max(outlines, key=len)
    ends = cv2.convexHull(outline, returnPoints=False)
    try:
        found = cv2.convexityDefects(outline, ends) if len(ends) > 3 else None
    except cv2.error:  # it touches itself all the same
        return []
    if found is None:
        return []
    # the depth of a defect is a fixed-point number with 8 bits behind the point
    deep = [row for row in found.reshape(-1, 4) if row[3] / 256.0 >= notch]
    deepest = sorted(deep, key=lambda row: -row[3])[:MOST_NOTCHES]
    points = [tuple(int(x) for x in outline.reshape(-1, 2)[row[2]]) for row in deepest]
    cuts = [parts for a, b in combinations(points, 2) if (parts := _cut(mask, a, b))]
    return max(cuts, key=_convexity, default=[])


def _cut(mask: Mask, a: Sequence[int], b: Sequence[int]) -> list[Mask]:
    """The two sides of a cut from `a` to `b`, both with its cells; none if it does not part the region."""
    cut = mask.astype(np.uint8)
    cv2.line(cut, a, b, 0, 2)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(cut, connectivity=4)
    if count < 3:
        return []
    largest = 1 + np.argsort(-stats[1:, cv2.CC_STAT_AREA])[:2]
    parts = [labels == i for i in largest]
    wide = [_widened(part, 2) | near for part, near in zip(parts, _nearest(parts), strict=True)]
    return [part & mask & ~other for part, other in zip(wide, parts[::-1], strict=True)]


def _convexity(parts: Sequence[Mask]) -> float:
    """Share of the convex hulls of some masks that the masks fill."""
    hulls = [cv2.convexHull(np.argwhere(part).astype(np.int32)) for part in parts]
    return float(sum(part.sum() for part in parts) / max(sum(cv2.contourArea(hull) for hull in hulls), 1.0))
