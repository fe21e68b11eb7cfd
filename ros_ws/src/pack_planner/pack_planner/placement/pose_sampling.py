"""Random upright poses on the container's base: SamplePose of Algorithm 1."""

from __future__ import annotations

import numpy as np

from pack_core.rotations import Array
from pack_core.scene.fit import fitting_yaws, half_spans
from pack_core.scene.objects import Box, Cylinder
from pack_core.scene.scene import Container


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
    yaws = rng.choice(fitting_yaws(item, container, yaw), n)
    room = 0.5 * np.array(container.size) - half_spans(item, yaws)
    poses = np.zeros((n, 7))
    poses[:, :2] = np.array(container.centre) + room * rng.uniform(-1.0, 1.0, (n, 2))
    poses[:, 2] = item.half_extents[2]
    poses[:, 3], poses[:, 6] = np.cos(yaws / 2), np.sin(yaws / 2)
    return poses
