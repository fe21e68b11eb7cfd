"""Where the models keep objects that no camera has seen yet."""

from __future__ import annotations

import numpy as np

from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Pose

PARKED = np.array([-5.0, 0.0])
"""Where the first of them stands, out of reach of everything else: x and y [m]."""
GAP = 1.0
"""Distance from one to the next [m]."""


def parked_pose(i: int, item: SceneItem) -> Pose:
    """X_WO of object number `i` of a scene while it is parked: it stands on the table's plane."""
    x, y = PARKED - (GAP * i, 0.0)
    return Pose(np.array([x, y, item.half_extents[2]]))
