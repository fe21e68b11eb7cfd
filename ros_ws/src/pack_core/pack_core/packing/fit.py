"""Whether an upright object fits into a container at all."""

from __future__ import annotations

import numpy as np

from pack_core.errors import PackError
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.scene import Container
from pack_core.rotations import Array

YAW_STEPS = 721


def symmetry(item: Box | Cylinder) -> float:
    """The smallest yaw that brings the upright object onto itself [rad]; 0: any does."""
    if isinstance(item, Cylinder):
        return 0.0
    return np.pi / 2 if item.size[0] == item.size[1] else np.pi


def half_spans(item: Box | Cylinder, yaws: Array) -> Array:
    """Half the extents `(n, 2)` along the world's x and y of the upright object at each yaw [m]."""
    x, y, _ = item.half_extents
    if isinstance(item, Cylinder):
        return np.full((len(yaws), 2), x)
    c, s = np.abs(np.cos(yaws)), np.abs(np.sin(yaws))
    return np.stack([c * x + s * y, s * x + c * y], axis=1)


def fitting_yaws(item: Box | Cylinder, container: Container, yaw: float) -> Array:
    """Evenly spread yaws, half a symmetry to each side of `yaw`, at which the object fits [rad].

    Raises:
        PackError: it is too wide at every yaw, or so tall that its centre would stand over the rim.
    """
    yaws = yaw + symmetry(item) * np.linspace(-0.5, 0.5, YAW_STEPS)
    room = 0.5 * np.array(container.size) - half_spans(item, yaws)
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
