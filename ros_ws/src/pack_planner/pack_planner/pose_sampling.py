"""Random upright poses on the container's base: SamplePose of Algorithm 1."""

from __future__ import annotations

import numpy as np

from pack_core.errors import PackError
from pack_core.rotations import Array
from pack_core.scene.objects import Box, Cylinder
from pack_core.scene.scene import Container

YAW_STEPS = 721


def sample_poses(
    item: Box | Cylinder, container: Container, n: int, yaw: float, rng: np.random.Generator
) -> Array:
    """Uniformly random poses at which the object stands on the base between the walls.

    Yaws that look alike are drawn once, by the smallest turn from `yaw`: none for a cylinder, a quarter
    turn's range for a square box, half a turn's for others.

    Args:
        item: the object.
        container: where it is to stand.
        n: how many.
        yaw: the object's present yaw [rad].
        rng: the source of randomness.

    Returns:
        Poses `(n, 7)`: position [m], quaternion wxyz.

    Raises:
        PackError: the object is too large for the container.
    """
    yaws = yaw + _yaw_range(item) * np.linspace(-0.5, 0.5, YAW_STEPS)
    room = 0.5 * np.array(container.size) - half_spans(item, yaws)
    yaws = yaws[np.all(room >= 0.0, axis=1)]
    _check_fits(item, container, is_narrow_enough=yaws.size > 0)
    yaws = rng.choice(yaws, n)
    room = 0.5 * np.array(container.size) - half_spans(item, yaws)
    poses = np.zeros((n, 7))
    poses[:, :2] = np.array(container.centre) + room * rng.uniform(-1.0, 1.0, (n, 2))
    poses[:, 2] = item.half_extents[2]
    poses[:, 3], poses[:, 6] = np.cos(yaws / 2), np.sin(yaws / 2)
    return poses


def _check_fits(item: Box | Cylinder, container: Container, *, is_narrow_enough: bool) -> None:
    x, y, z = (2 * item.half_extents).tolist()
    if not is_narrow_enough:
        raise PackError(
            f"'{item.name}' is {x:.3f} x {y:.3f} m wide, the container {container.size[0]:.3f} x "
            f"{container.size[1]:.3f} m; allowed: what fits between the walls at some yaw"
        )
    if z >= 2 * container.height:
        raise PackError(
            f"'{item.name}' is {z:.3f} m tall, the container's walls {container.height:.3f} m; allowed: less "
            f"than {2 * container.height:.3f} m, so that its centre is below the rim"
        )


def _yaw_range(item: Box | Cylinder) -> float:
    """The smallest yaw that brings the object onto itself [rad]; 0 for any."""
    if isinstance(item, Cylinder):
        return 0.0
    return np.pi / 2 if item.size[0] == item.size[1] else np.pi


def half_spans(item: Box | Cylinder, yaws: Array) -> Array:
    """Half the extent `(n, 2)` along the world's x and y of the object at each yaw [m]."""
    x, y, _ = item.half_extents
    if isinstance(item, Cylinder):
        return np.full((len(yaws), 2), x)
    c, s = np.abs(np.cos(yaws)), np.abs(np.sin(yaws))
    return np.stack([c * x + s * y, s * x + c * y], axis=1)
