"""A look at objects that nobody described: images in, a scene with shapes, sizes and poses out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from operator import itemgetter

import cv2
import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.objects import Capsule
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import SceneItem, colour_of
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import Array, Pose, yaw_of
from pack_perception.depth.deviations import deviations_of
from pack_perception.depth.height_map import (
    HeightMap,
    Mask,
    halves,
    height_map,
    is_flat,
    pieces,
    regions,
)
from pack_perception.depth.seen_region import overlap, seen_region
from pack_perception.depth.shape_fit import FittedShape, candidates, worth
from pack_perception.depth.sight_lines import SightLines
from pack_perception.depth.tool_shape import ToolShape
from pack_perception.perception_config import DepthLookConfig

BELOW_HELD = 0.01
"""What is nearer to the lower end of the held object, or higher, is no content of the container [m]."""
BESIDE = 0.03
"""From the container's walls; a held object farther away hides nothing in it [m]."""
ARM_REACH = 0.08
"""What is higher than the cup, and nearer to its axis, is the pump [m]."""
OF_TOOL = 0.004
"""What is nearer to the tool's surface is a part of it [m]."""
HIGH = 0.03
"""Nothing that stands in the container is so much higher than all that is known to be there [m]."""
GAP = 7
"""Size of the square by which a top is widened to meet another one across a gap of unseen cells [cells]."""

TOPMOST = 0.9
"""Share of a top's cells below what counts as its height, as less or more is seen of round sides."""
AXIS_SHARE = 0.7
"""Share of a capsule's radius beside its axis in which it is looked for behind a gap."""
UNLIKELY_GAIN = 0.02
"""By which two boxes, or a hull and another shape, must overlap better with a region than anything else."""
ROUNDS = 2
"""How often the cells of a region are shared out anew among two shapes."""
FEW_CELLS = 3
"""Fewer cells than these say nothing."""


@dataclass(frozen=True)
class SeenShape(FittedShape):
    """A shape that stands for an object, and how sure that is."""

    deviations: SeenDeviations


def off_container(points: Array, container: Container, on_wall: float) -> Array:
    """Those of `points` `(n, 3)` [m] that are farther than `on_wall` [m] from the base and the walls."""
    (x0, y0), (x1, y1), t = (
        container.lower + on_wall,
        container.upper - on_wall,
        container.wall + 2.0 * on_wall,
    )
    x, y, z = points.T
    is_between = (x > x0) & (x < x1) & (y > y0) & (y < y1)
    is_beside = (x < x0 - t) | (x > x1 + t) | (y < y0 - t) | (y > y1 + t)
    is_above = z > container.height + on_wall
    return np.asarray(points[(z > on_wall) & (is_between | is_beside | is_above)])


def ceiling_below(held: SceneItem, X_WN: Pose, container: Container) -> float:
    """Height over which there is nothing but the held object, which is at X_WN, or the arm [m].

    One that is not over the container hides nothing in it; the centre of what is packed is below the rim.
    """
    hull = X_WN.apply(held.hull())
    low, high = container.lower - BESIDE, container.upper + BESIDE
    if np.any((hull[:, :2].max(axis=0) < low) | (hull[:, :2].min(axis=0) > high)):
        return 2.0 * container.height
    return float(hull[:, 2].min()) - BELOW_HELD


def off_arm(points: Array, X_WT: Pose, rim: float) -> Array:
    """Those of `points` `(n, 3)` [m] that are not of the arm; `rim` is the scene's [m]."""
    p_T = X_WT.inverse().apply(points)  # the cup's z axis points away from the arm
    is_pump = (p_T[:, 2] < BELOW_HELD) & (np.linalg.norm(p_T[:, :2], axis=1) < ARM_REACH)
    return np.asarray(points[~is_pump & (points[:, 2] <= rim + HIGH)])


def off_tool(points: Array, X_WT: Pose, tool: ToolShape) -> Array:
    """Those of `points` `(n, 3)` [m] that are not of the tool.

    Else the cup would pass for a part of what hangs from it where that is hardly wider.
    """
    p_T = X_WT.inverse().apply(points)
    rho = np.hypot(p_T[:, 0], p_T[:, 1])
    near = np.flatnonzero((p_T[:, 2] < OF_TOOL) & (rho < tool.radii.max() + OF_TOOL))
    distances, _ = tool.distances(p_T[near])
    return np.delete(points, near[distances < OF_TOOL], axis=0)


def look_at(
    points: Array, sight: SightLines, container: Container, config: DepthLookConfig, before: int = 0,
    known: Sequence[shapely.Polygon] = (),
) -> list[SeenShape]:  # fmt: skip
    """The objects in a container.

    Args:
        points: all that was measured `(n, 3)` [m], without arm and held object.
        sight: the cameras' images, which tell where nothing is.
        container: where they stand.
        config: parameters.
        before: how many objects earlier looks have named.
        known: outlines of objects that are not looked for.

    Returns:
        An object for each region of tops, the largest first; their names are `seen_1` and so on, or go on
        behind those of earlier looks.
    """
    heights = height_map(points, sight, container, config.heights)
    found: list[FittedShape] = []
    taken = _within(known, heights)
    least = config.heights.min_area / heights.cell**2
    masks = [rest for mask in regions(heights, config.heights) if (rest := mask & ~taken).sum() >= least]
    for mask in _with_pieces(_joined(masks, heights, config), heights, config):
        rest = mask & ~taken
        if rest.sum() < least:
            continue
        for shape in _objects_of(rest, heights, config):
            longer = _continued(shape, rest, heights, config)
            if longer is not shape:  # what is seen behind the gap is no object of its own
                taken |= _within([footprint(longer.item, longer.X_WO)], heights)
            found.append(longer)
    return [_named(f, f"seen_{i}", heights, config) for i, f in enumerate(found, before + 1)]


def _within(outlines: Sequence[shapely.Polygon], heights: HeightMap) -> Mask:
    """The cells `(nx, ny)` of outlines, with their edges."""
    whole = shapely.union_all(outlines).buffer(heights.cell)
    return np.asarray(shapely.contains_xy(whole, heights.centres()).reshape(heights.tops.shape))


def _named(fit: FittedShape, name: str, heights: HeightMap, config: DepthLookConfig) -> SeenShape:
    item = fit.item.model_copy(update={"name": name, "colour": colour_of(name)})
    return SeenShape(item, fit.X_WO, fit.score, fit.points, deviations_of(fit, heights, config))


def _joined(masks: list[Mask], heights: HeightMap, config: DepthLookConfig) -> list[Mask]:
    """The regions, those joined that a gap in what was seen has cut: one simple shape explains both."""
    for a, b in combinations(masks, 2):
        if _is_one(a, b, heights, config):
            rest = [mask for mask in masks if mask is not a and mask is not b]
            return _joined([a | b, *rest], heights, config)
    return masks


def _with_pieces(masks: Sequence[Mask], heights: HeightMap, config: DepthLookConfig) -> list[Mask]:
    """The regions with what is cut off them and too small to be an object, where it has their shape."""
    whole = list(masks)
    for piece in pieces(heights, masks, config.heights):
        for i, mask in enumerate(whole):
            shape = _shape_of_both(mask, piece, heights, config)
            alone = _best(mask, heights, config) if shape is not None else None
            if shape is not None and alone is not None and shape.score >= alone.score - config.gain:
                whole[i] = mask | piece
                break
    return whole


def _is_one(a: Mask, b: Mask, heights: HeightMap, config: DepthLookConfig) -> bool:
    """Whether one simple shape explains two tops as well as two do."""
    whole = _shape_of_both(a, b, heights, config)
    if whole is None:
        return False
    parts = _parts([a, b], heights, config)
    return whole.score >= overlap([(fit.item, fit.X_WO) for _, fit in parts], a | b, heights) - config.gain


def _shape_of_both(a: Mask, b: Mask, heights: HeightMap, config: DepthLookConfig) -> FittedShape | None:
    """The simple shape of two tops if they are as high as each other, and beside each other; else None."""
    levels = [np.nanquantile(heights.tops[mask], TOPMOST) for mask in (a, b)]
    wide = cv2.dilate(a.astype(np.uint8), np.ones((GAP, GAP), np.uint8)).astype(bool)
    if abs(levels[0] - levels[1]) > config.heights.flat or not np.any(wide & b):
        return None
    if is_flat(heights, a, config.heights) != is_flat(heights, b, config.heights):
        return None
    whole = _best(a | b, heights, config)
    return whole if whole is not None and whole.item.shape != "mesh" else None


def _objects_of(mask: Mask, heights: HeightMap, config: DepthLookConfig) -> list[FittedShape]:
    """The object of a region, or two if they explain it better."""
    shapes = _shapes_of(mask, heights, config)
    if not shapes:
        return []
    whole = shapes[0]
    if whole.item.shape == "capsule" or (whole.score >= config.good and whole.item.shape != "mesh"):
        return [whole]
    first = _parts(halves(mask, config.heights.notch / heights.cell), heights, config)
    if len(first) < 2:
        return [whole]
    # both parts have the cells of the cut; now each cell goes to the shape that it is nearer to
    splits = [first, _shared_out(mask, first, heights, config)]
    if sum(fit.item.shape == "mesh" for _, fit in splits[-1]) == 1:
        # a hull keeps what the cut left of the other part; a simple shape lets go of it
        plain = _parts([part for part, _ in first], heights, config, simple=True)
        for _ in range(ROUNDS):
            plain = _shared_out(mask, plain, heights, config, simple=True) if len(plain) > 1 else plain
        splits += [plain] if len(plain) > 1 else []
    scored = [
        (_advantage([fit for _, fit in split], shapes, mask, heights, config), split) for split in splits
    ]
    advantage, split = max(scored, key=itemgetter(0))
    if advantage <= 0.0:
        return [whole]
    # a part that only a hull fits may be two objects again
    return [
        shape
        for part, fit in split
        for shape in (_objects_of(part, heights, config) if fit.item.shape == "mesh" else [fit])
    ]


def _continued(fit: FittedShape, mask: Mask, heights: HeightMap, config: DepthLookConfig) -> FittedShape:
    """A lying capsule with what lies straight on behind something in front of it."""
    more = _continuation(fit, heights, config.shapes.close) & ~mask
    longer = _best(mask | more, heights, config) if more.sum() >= FEW_CELLS else None
    return longer if longer is not None and longer.item.shape == "capsule" else fit


def _continuation(fit: FittedShape, heights: HeightMap, close: float) -> Mask:
    """Cells `(nx, ny)` on a lying capsule's axis, beyond its ends, that are as high as it.

    It goes on over cells in which nothing was seen, up to those that are higher or lower.
    """
    more = np.zeros(heights.tops.size, dtype=bool)
    if not isinstance(fit.item, Capsule):
        return more.reshape(heights.tops.shape)
    radius, yaw, tops = fit.item.radius, yaw_of(fit.X_WO.q), heights.tops.ravel()
    p = heights.centres() - fit.X_WO.p[:2]
    along, across = p @ [np.cos(yaw), np.sin(yaw)], p @ [-np.sin(yaw), np.cos(yaw)]
    is_on_axis = (np.abs(across) < AXIS_SHARE * radius) & np.isfinite(tops)
    expected = radius + np.sqrt(np.maximum(radius**2 - across**2, 0.0))
    is_near = is_on_axis & (np.abs(tops - expected) < close)
    for sign in (1.0, -1.0):
        ways = sign * along - (0.5 * fit.item.length - radius)
        others = np.sort(ways[is_on_axis & ~is_near & (ways > 0.0)])
        reach = others[FEW_CELLS - 1] if len(others) >= FEW_CELLS else np.inf
        more |= is_near & (ways > 0.0) & (ways < reach)
    return more.reshape(heights.tops.shape)


def _shared_out(
    mask: Mask, split: Sequence[tuple[Mask, FittedShape]], heights: HeightMap, config: DepthLookConfig,
    *, simple: bool = False,
) -> list[tuple[Mask, FittedShape]]:  # fmt: skip
    """The split in which each cell of a region goes to the shape of `split` that it is nearer to."""
    return _parts(_nearer(mask, [fit for _, fit in split], heights), heights, config, simple=simple)


def _advantage(
    split: Sequence[FittedShape], wholes: Sequence[FittedShape], mask: Mask, heights: HeightMap,
    config: DepthLookConfig,
) -> float:  # fmt: skip
    """By how much parts explain a region better than one of the shapes of the whole; 0 or less: not enough.

    Shapes are compared by their overlap, less the handicap of those that are hulls.
    """
    kinds = {fit.item.shape for fit in split}
    # hulls fit whatever is left of a region, so that two of them say nothing
    if kinds == {"mesh"}:
        return -np.inf
    handicap = np.mean([part.score - worth(part) for part in split])
    score = overlap([(part.item, part.X_WO) for part in split], mask, heights) - float(handicap)
    if "mesh" not in kinds and kinds != {"box"}:
        return score - worth(wholes[0]) - config.gain
    # any box can be cut into two; the hull of the whole, too, fills the notches between two
    return score - max(worth(wholes[0]), *(fit.score for fit in wholes)) - UNLIKELY_GAIN


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


def _parts(
    masks: Sequence[Mask], heights: HeightMap, config: DepthLookConfig, *, simple: bool = False
) -> list[tuple[Mask, FittedShape]]:
    """The parts of a region and what fits each best, without those that are too small for an object."""
    large = [part for part in masks if part.sum() * heights.cell**2 >= config.heights.min_area]
    return [(part, fit) for part in large if (fit := _best(part, heights, config, simple=simple)) is not None]


def _best(
    mask: Mask, heights: HeightMap, config: DepthLookConfig, *, simple: bool = False
) -> FittedShape | None:
    """The shape that fits a region best, or the best one that is no hull; None if there is none."""
    shapes = _shapes_of(mask, heights, config)
    return next((fit for fit in shapes if not simple or fit.item.shape != "mesh"), None)


def _shapes_of(mask: Mask, heights: HeightMap, config: DepthLookConfig) -> list[FittedShape]:
    """The shapes that may have a region as their top, the best one first."""
    region = seen_region(heights, mask, config.shapes.side)
    flat = is_flat(heights, mask, config.heights)
    return candidates(region, heights, "seen", config.shapes, flat=flat, good=config.good)
