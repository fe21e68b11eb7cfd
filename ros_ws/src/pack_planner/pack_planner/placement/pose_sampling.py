"""Random upright poses on the container's base: SamplePose of Algorithm 1, and poses near one."""

from __future__ import annotations

import numpy as np

from pack_core.packing.fit import fitting_yaws
from pack_core.packing.scene import Container
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, yaw_of


def sample_poses(
    item: SceneItem, container: Container, n: int, yaw: float, rng: np.random.Generator
) -> Array:
    """Uniformly random poses at which the object stands on the base between the walls.

    Of yaws at which the object looks the same, only the one nearest to `yaw` is drawn: the range is zero for
    a cylinder, a quarter turn for a square box and half a turn for other boxes.

    Args:
        item: the object.
        container: where it is to stand.
        n: number of poses.
        yaw: the object's present yaw [rad].
        rng: the source of randomness.

    Returns:
        Poses `(n, 7)`: position [m], quaternion wxyz.

    Raises:
        PackError: the object is too large for the container.
    """
    yaws = rng.choice(fitting_yaws(item, container, yaw), n)
    room = 0.5 * np.array(container.size) - item.half_spans(yaws)
    return _standing(item, container, room * rng.uniform(-1.0, 1.0, (n, 2)), yaws)


def sample_near(
    X_WN: Pose,
    item: SceneItem,
    container: Container,
    n: int,
    deviation: tuple[float, float],
    rng: np.random.Generator,
) -> Array:
    """Upright poses `(n, 7)` scattered about X_WN and kept between the walls.

    Args:
        X_WN: where the object stands.
        item: the object.
        container: where it is to stand.
        n: number of poses.
        deviation: standard deviations of the position [m] and of the yaw [rad].
        rng: the source of randomness.
    """
    yaws = yaw_of(X_WN.q) + deviation[1] * rng.normal(size=n)
    room = np.maximum(0.5 * np.array(container.size) - item.half_spans(yaws), 0.0)
    offsets = X_WN.p[:2] - container.centre + deviation[0] * rng.normal(size=(n, 2))
    return _standing(item, container, np.clip(offsets, -room, room), yaws)


def _standing(item: SceneItem, container: Container, offsets: Array, yaws: Array) -> Array:
    """Poses `(n, 7)` on the base, at offsets `(n, 2)` [m] from its middle."""
    poses = np.zeros((len(yaws), 7))
    poses[:, :2] = np.array(container.centre) + offsets
    poses[:, 2] = item.half_extents[2]
    # w and z of the quaternion of a rotation about z
    poses[:, 3], poses[:, 6] = np.cos(yaws / 2), np.sin(yaws / 2)
    return poses
