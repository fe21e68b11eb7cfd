"""What an action sweeps on the table: oriented rectangles.

A rectangle is a row: centre x, y [m], cosine and sine of its heading, half extents along and across it [m].
Poses are rows x, y, yaw. Blocks are of one height and are carried above the others, so that only where the
gripper and the block come down matters.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER, PlanarPose
from pack_core.rotations import Array


def rows_of(poses: Iterable[PlanarPose]) -> Array:
    """Poses as rows of x [m], y [m], yaw [rad], `(n, 3)`."""
    return np.array([pose.row for pose in poses], dtype=float).reshape(-1, 3)


def rectangles(
    poses: npt.ArrayLike, half_x: npt.ArrayLike, half_y: npt.ArrayLike,
    x: npt.ArrayLike = 0.0, y: npt.ArrayLike = 0.0,
) -> Array:  # fmt: skip
    """Rectangles `(..., 6)` whose centres lie at x, y [m] in the frames of poses `(..., 3)`."""
    pose = np.asarray(poses, dtype=float)
    cosine, sine = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    rows = np.empty((*np.broadcast_shapes(cosine.shape, np.shape(half_x), np.shape(x)), 6))
    rows[..., 0] = pose[..., 0] + cosine * x - sine * y
    rows[..., 1] = pose[..., 1] + sine * x + cosine * y
    rows[..., 2], rows[..., 3] = cosine, sine
    rows[..., 4], rows[..., 5] = half_x, half_y
    return rows


def squares(poses: npt.ArrayLike, side: float, margin: float = 0.0) -> Array:
    """The blocks themselves, grown by a margin [m], `(..., 6)`."""
    half = side / 2 + margin
    return rectangles(poses, half, half)


def fingers(poses: npt.ArrayLike, side: float, gripper: GripperFootprint) -> Array:
    """Beside the faces that a grasp touches: `(..., grasp, finger, 6)` for both grasps and fingers."""
    thickness, width = gripper.slab_thickness, gripper.slab_width
    reach = (side + thickness) / 2 * np.array([1.0, -1.0])
    return rectangles(_turned(poses)[..., None, :], thickness / 2, width / 2, reach)


def placings(poses: npt.ArrayLike, side: float, gripper: GripperFootprint) -> Array:
    """Fingers and block where it is put down, `(..., grasp, 3, 6)`."""
    block = squares(_turned(poses), side, gripper.block_margin)
    return np.concatenate([fingers(poses, side, gripper), block[..., None, :]], axis=-2)


def sweeps(
    ends: npt.ArrayLike, headings: npt.ArrayLike, distances: npt.ArrayLike, side: float,
    gripper: GripperFootprint,
) -> Array:  # fmt: skip
    """The whole room of pushes that end at poses `(..., 3)`, `(..., 6)`.

    From the gripper's rear where it comes down to the block's front where it stops; as wide as the block,
    behind which the almost closed gripper hides.
    """
    pose = np.array(ends, dtype=float)
    pose[..., 2] = headings
    front = side / 2 + gripper.block_margin
    rear = np.asarray(distances) + side / 2 + gripper.push_tail
    half_width = max(front, gripper.push_width / 2 + gripper.safety_margin)
    return rectangles(pose, (front + rear) / 2, half_width, (front - rear) / 2)


def _turned(poses: npt.ArrayLike) -> Array:
    """Poses `(..., 2, 3)` with x along the direction in which either grasp closes."""
    pose = np.asarray(poses, dtype=float)
    turned = np.stack([pose, pose], axis=-2)
    turned[..., 1, 2] += QUARTER
    return turned
