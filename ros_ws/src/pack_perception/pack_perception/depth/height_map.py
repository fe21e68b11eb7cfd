"""A map of the heights in the container, and the regions in it that are the tops of single objects."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pack_core.config import Config
from pack_core.packing.scene import Container
from pack_core.rotations import Array

Mask = npt.NDArray[np.bool_]
Labels = npt.NDArray[np.int_]

EDGE = 5
"""Width of what is left beside tops and is no edge of theirs [cells]."""
STEEP_CELLS = 20
"""Most cells by which a round top goes on beyond where it gets steep: the shoulder of a bottle, 5 cm."""


class HeightMapConfig(Config):
    """How heights become regions."""

    cell: PositiveFloat = Field(default=0.0025, description="edge of a cell of the map of heights [m]")
    flier: PositiveFloat = Field(
        default=0.006,
        description="a cell's highest point counts if the next one is at most this far below [m]",
    )
    floor: PositiveFloat = Field(default=0.015, description="what is lower is the container's base [m]")
    jump: PositiveFloat = Field(default=0.0025, description="step between cells at which a top ends [m]")
    slope: PositiveFloat = Field(default=0.02, description="step down to which a round top goes on [m]")
    flat: PositiveFloat = Field(
        default=0.002, description="a top whose heights spread by less than this is flat [m]"
    )
    min_area: PositiveFloat = Field(default=0.0004, description="smallest region that is an object [m^2]")
    notch: PositiveFloat = Field(
        default=0.004,
        description="depth of two notches in an outline at which a region may be two objects [m]",
    )


@dataclass(frozen=True)
class HeightMap:
    """Heights of the tops over the container's base.

    Attributes:
        lower: the container's inner corner with the smallest x and y `(2,)` [m].
        cell: edge of a cell [m].
        tops: mean height of the top in each cell `(nx, ny)` [m]; nan where nothing was seen.
    """

    lower: Array
    cell: float
    tops: Array

    def cells_of(self, points: Array) -> tuple[Labels, Mask]:
        """Cells `(n, 2)` of points `(n, 2)` or `(n, 3)` [m], and which of them are inside `(n,)`."""
        cells = np.floor((points[:, :2] - self.lower) / self.cell).astype(int)
        return cells, np.all((cells >= 0) & (cells < self.tops.shape), axis=1)

    def centres(self, mask: Mask | None = None) -> Array:
        """Centres `(n, 2)` [m] of the cells of a mask `(nx, ny)`; None: of all, row by row."""
        cells = np.argwhere(np.ones(self.tops.shape, dtype=bool) if mask is None else mask)
        return np.asarray(self.lower + (cells + 0.5) * self.cell)


def height_map(points: Array, container: Container, config: HeightMapConfig) -> HeightMap:
    """The map of points `(n, 3)` [m]; points outside of the walls are left out."""
    shape = tuple(math.ceil(side / config.cell) for side in container.size)
    empty = HeightMap(container.lower, config.cell, np.full(shape, np.nan))
    cells, inside = empty.cells_of(points)
    numbers, z = cells[inside] @ np.array([shape[1], 1]), points[inside, 2]
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
    return HeightMap(container.lower, config.cell, _without_holes(tops))


def _without_holes(tops: Array) -> Array:
    """Single unseen cells get the median of their neighbours, if most of these were seen."""
    padded = np.pad(tops, 1, constant_values=np.nan)
    around = np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).reshape(*tops.shape, 9)
    holes = np.isnan(tops) & (np.isfinite(around).sum(axis=-1) >= 5)
    filled = tops.copy()
    filled[holes] = np.nanmedian(around[holes], axis=-1)
    return filled


def regions(heights: HeightMap, config: HeightMapConfig) -> list[Mask]:
    """Connected tops `(nx, ny)` that end where the height jumps, the largest first."""
    tops = heights.tops
    above, least = tops > config.floor, config.min_area / heights.cell**2
    found = _connected(tops, above, config.jump, least)
    found = [mask if is_flat(heights, mask, config) else _grown(mask, found, tops, config) for mask in found]
    # what a bridge joined to a larger top, then tops that are steep all over; edges of others are narrow
    for step in (config.jump, config.slope):
        rest = above & ~np.any([*found, ~above], axis=0)
        wide = cv2.morphologyEx(rest.astype(np.uint8), cv2.MORPH_OPEN, np.ones((EDGE, EDGE), np.uint8)) > 0
        found += _connected(tops, wide, step, 2.0 * least)
    return sorted(found, key=lambda mask: -mask.sum())


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
    large = [i for i in np.argsort(-sizes) if sizes[i] >= least]
    parts = [_opened((labels == i).reshape(tops.shape) & cells) for i in large]
    return [part for part in parts if part.sum() >= least]


def is_flat(heights: HeightMap, mask: Mask, config: HeightMapConfig) -> bool:
    """Whether a top is level, but for its edges."""
    low, high = np.percentile(heights.tops[mask & np.isfinite(heights.tops)], [10, 90])
    return bool(high - low < 2.0 * config.flat)


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
    """The two parts of a region that is cut between its two deepest notches; none if it has no two.

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
    deep = sorted((row for row in found.reshape(-1, 4) if row[3] / 256.0 >= notch), key=lambda row: -row[3])[
        :2
    ]
    if len(deep) < 2:
        return []
    cut = mask.astype(np.uint8)
    a, b = (tuple(int(x) for x in outline.reshape(-1, 2)[row[2]]) for row in deep)
    cv2.line(cut, a, b, 0, 2)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(cut, connectivity=4)
    largest = 1 + np.argsort(-stats[1:, cv2.CC_STAT_AREA])[:2]
    if count < 3:
        return []
    # the cells of the cut go to both parts
    parts = [cv2.dilate((labels == i).astype(np.uint8), np.ones((5, 5), np.uint8)) > 0 for i in largest]
    return [part & mask & ~(labels == other) for part, other in zip(parts, largest[::-1], strict=True)]
