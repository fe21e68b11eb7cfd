"""How full a container is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from pack_core.hull import hull_of
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Pose


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
