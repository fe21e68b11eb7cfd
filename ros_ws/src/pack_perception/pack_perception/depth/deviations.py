"""How sure a look is of what it saw.

An outline ends where it was seen to end, within an error that depends on the shape. Where nobody saw what is
beyond, the object may go on as far as nothing else is known to be: the error there grows with that gap.
Length and middle follow from both ends, the heading from the two long sides.
"""

from __future__ import annotations

import numpy as np
import shapely

from pack_core.packing.free_space import footprint
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import Array, yaw_of
from pack_perception.depth.height_map import HeightMap, Mask
from pack_perception.depth.shape_fit import FittedShape
from pack_perception.perception_config import DepthLookConfig, SpreadConfig

LINES = np.array([0.15, 0.325, 0.5, 0.675, 0.85])
"""Where lines leave an outline to find what is beyond it, in parts of its width."""
CLOSED = 0.75
"""Share of the lines by which what is beyond an end is judged: a corner alone may be hidden."""
FIRST, STEPS = 1.5, 60
"""Where a line begins behind the outline, and how far it is followed [cells]."""
LEVELS = (0.5, 0.75, 0.95)
"""Heights at which a camera that saw through tells where an upright object ends, in parts of its own."""


def deviations_of(fit: FittedShape, heights: HeightMap, config: DepthLookConfig) -> SeenDeviations:
    """Standard deviations of the place, the size and the heading of what was seen."""
    spread: SpreadConfig = getattr(config.spreads, fit.item.shape)
    yaw = yaw_of(fit.X_WO.q)
    outline = footprint(fit.item, fit.X_WO)
    own = shapely.contains_xy(outline.buffer(FIRST * heights.cell), heights.centres())
    corners, mask = shapely.get_coordinates(outline), own.reshape(heights.tops.shape)
    gaps = np.array([_gap(fit, corners, mask, yaw + 0.5 * np.pi * k, heights) for k in range(4)])
    ends = np.hypot(spread.end, config.open_end * gaps)
    # the ends along x are the first and the third, those along y the second and the fourth
    length, width = np.hypot(ends[:2], ends[2:])
    position, size = (0.5 * length, 0.5 * width, 0.5 * spread.height), (length, width, spread.height)
    half = fit.item.half_extents[:2]
    long = int(np.argmax(half))
    has_heading = fit.item.shape in ("box", "capsule")
    turn = spread.turn * (width, length)[long] / (2.0 * half[long])
    return SeenDeviations(
        position=tuple(map(float, position)), size=tuple(map(float, size)),
        yaw=float(turn) if has_heading else None,
    )  # fmt: skip


def _gap(fit: FittedShape, corners: Array, own: Mask, direction: float, heights: HeightMap) -> float:
    """How far an object may go on in a direction [rad] until something else is known to be there [m]."""
    along = np.array([np.cos(direction), np.sin(direction)])
    across = np.array([-along[1], along[0]])
    end, (low, high) = (corners @ along).max(), np.quantile(corners @ across, [0.0, 1.0])
    steps = heights.cell * np.arange(FIRST, STEPS)
    starts = end * along + (low + LINES * (high - low))[:, None] * across
    places = starts[:, None] + steps[:, None] * along
    levels = LEVELS if isinstance(fit.item, Box | Cylinder) else LEVELS[:1]
    height = 2.0 * fit.item.half_extents[2]
    is_apart = np.any(
        [
            heights.is_known_apart(np.insert(places.reshape(-1, 2), 2, share * height, axis=1), own)
            for share in levels
        ],
        axis=0,
    ).reshape(places.shape[:2])
    firsts = np.where(is_apart.any(axis=1), np.argmax(is_apart, axis=1), len(steps) - 1)
    # the first step is taken by every object
    return float(np.quantile(steps[firsts] - steps[0], CLOSED))
