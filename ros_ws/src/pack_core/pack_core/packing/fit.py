"""Whether an upright object fits into a container at all."""

from __future__ import annotations

import numpy as np

from pack_core.errors import PackError
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array

YAW_STEPS = 721
"""Candidate yaws: a quarter of a degree apart for an object with a symmetry of 180 degrees."""


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
