"""Room in the container: where an upright object would stand free, whether it fits at all, how full it is.

Everything is seen from above: bodies are their convex footprints, and the places of the new object's
centre that are taken by a body are the Minkowski sum of both footprints. A body counts with its whole
footprint, whatever its height, since the new object reaches down to the base.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from pack_core.errors import PackError
from pack_core.hull import hull_of
from pack_core.no_fit import no_fit_polygon
from pack_core.packing.scene import Container, Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, from_yaw

YAW_STEP = np.deg2rad(1.0)
"""Distance between the yaws at which `is_blocked` looks for a free place [rad]."""
SMALLEST_AREA = 1e-10
"""A free area smaller than this is a rounding error [m^2]."""
YAW_STEPS = 721
"""Candidate yaws: a quarter of a degree apart for an object with a symmetry of 180 degrees."""


def footprint(item: SceneItem, X_WO: Pose) -> shapely.Polygon:
    """The object's outline as seen from above [m]."""
    return shapely.MultiPoint(X_WO.apply(item.hull())[:, :2]).convex_hull


def outlines(scene: Scene) -> list[shapely.Polygon]:
    """The outlines of the objects in the container."""
    return [footprint(scene.model_of(name), X_WO) for name, X_WO in scene.poses().items()]


def base_height(item: SceneItem, X_WO: Pose) -> float:
    """Height of the object's lowest point over the table [m]."""
    return float(X_WO.apply(item.hull())[:, 2].min())


def free_places(
    item: SceneItem, yaw: float, container: Container, taken: list[shapely.Polygon], margin: float = 0.0
) -> shapely.Geometry:
    """Places of an upright object's centre at which it stands between the walls and touches nothing.

    Args:
        item: the object.
        yaw: yaw of the object [rad].
        container: the container between whose walls it has to stand.
        taken: outlines of the objects in the container.
        margin: distance by which the object's own outline is shrunk [m].
    """
    outline = footprint(item, Pose(np.zeros(3), from_yaw(yaw))).buffer(-margin, join_style="mitre")
    reach = np.array(outline.bounds).reshape(2, 2)
    lower, upper = container.lower - reach[0], container.upper - reach[1]
    if np.any(lower > upper):
        return shapely.Polygon()
    corners = shapely.get_coordinates(outline)
    met = [no_fit_polygon(shapely.get_coordinates(other), corners) for other in taken]
    return shapely.box(*lower, *upper).difference(shapely.union_all(met))


def is_blocked(scene: Scene) -> bool:
    """Whether the upright new object has no collision-free place, at any yaw.

    Yaws are tried every degree, with an outline that is shrunk by as much as half a step of yaw can move it.
    A place that is free only between two tried yaws is therefore found as well.
    """
    item, taken = scene.new_object, outlines(scene)
    yaws = np.arange(0.0, max(item.symmetry, YAW_STEP), YAW_STEP)
    # a point of the outline is at most a half diagonal off the centre, and half a step turns it by that times
    # the angle; a round object's outline does not move at all
    margin = 0.0 if item.symmetry == 0.0 else float(np.hypot(*item.half_extents[:2])) * YAW_STEP / 2
    return all(free_places(item, yaw, scene.container, taken, margin).area < SMALLEST_AREA for yaw in yaws)


def is_inside(outline: shapely.Polygon, container: Container, tolerance: float = 0.0) -> bool:
    """Whether the outline lies between the walls, exceeding them by at most `tolerance` [m]."""
    return bool(shapely.box(*container.lower, *container.upper).buffer(tolerance).covers(outline))


def is_packed(scene: Scene, X_WO: Pose) -> bool:
    """Whether an object's centre is between the walls and below their rim (section II)."""
    lower, upper = scene.container.lower, scene.container.upper
    return bool(np.all((X_WO.p[:2] > lower) & (X_WO.p[:2] < upper)) and X_WO.p[2] < scene.container.height)


def fitting_yaws(item: SceneItem, container: Container, yaw: float) -> Array:
    """Yaws [rad] at which the object fits, evenly spread over half a symmetry to either side of `yaw`.

    Raises:
        PackError: it is too wide at every yaw, or so tall that its centre would stand over the rim.
    """
    yaws = yaw + item.symmetry * np.linspace(-0.5, 0.5, YAW_STEPS)
    room = 0.5 * np.array(container.size) - item.half_spans(yaws)
    yaws = yaws[np.all(room >= 0.0, axis=1)]
    x, y, z = (2 * item.half_extents).tolist()
    if yaws.size == 0:
        raise PackError(
            f"'{item.name}' is {x:.3f} x {y:.3f} m wide, the container {container.size[0]:.3f} x "
            f"{container.size[1]:.3f} m; allowed: what fits between the walls at some yaw"
        )
    if z >= 2 * container.height:
        raise PackError(
            f"'{item.name}' is {z:.3f} m tall, the container's walls {container.height:.3f} m; allowed: less "
            f"than {2 * container.height:.3f} m, so that its centre is below the rim"
        )
    return yaws


@dataclass(frozen=True)
class Fill:
    """How full a container is.

    Attributes:
        base_area: share of the base that objects cover.
        volume: share of the container's volume, up to its rim, that objects take.
    """

    base_area: float
    volume: float


def fill_of(container: Container, standing: Sequence[tuple[SceneItem, Pose]]) -> Fill:
    """How full the container is with objects at X_WO; of an object's volume the part below the rim counts."""
    outlines = [footprint(item, X_WO) for item, X_WO in standing]
    area = float(np.prod(container.size))
    box = shapely.box(*container.lower, *container.upper)
    covered = shapely.union_all(outlines).intersection(box).area if outlines else 0.0
    volumes = [hull_of(X_WO.apply(item.hull())).volume_below(container.height) for item, X_WO in standing]
    return Fill(float(covered) / area, float(sum(volumes)) / (area * container.height))
