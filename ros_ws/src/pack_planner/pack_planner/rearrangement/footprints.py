"""What blocks and actions cover on the table, whether it lies in the workspace, and what overlaps.

What an action sweeps is a union of oriented rectangles. A rectangle is a row: centre x, y [m], cosine and
sine of its heading, half extents along and across it [m]. Poses are rows x, y, yaw. Blocks are carried above
the others, so that only where the gripper and the block come down matters.

A block's shape is a row, too: its edges along its own x and y, and its rise, by which the tallest block of
the problem stands above it [m]. Fingers are wedges: the more a neighbour may rise, the thicker they count.

Blocks may be put down in a convex polygon. Which blocks an action would hit is found by separating axes and
kept as bits: bit `q` of a word row says that the footprint overlaps block `q`; touching is not overlapping.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt
from numba import njit

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER, PlanarPose
from pack_core.blocks.problem import BlockSize, Point
from pack_core.rotations import Array

SLACK = 1e-9
"""Poses on the very edge are inside [m]."""
Words = npt.NDArray[np.uint64]
BITS = 64
"""Of a word of a set."""
TOUCH = 1e-7
"""Overlaps less deep than this are touching [m]."""


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


def shapes_of(sizes: Iterable[BlockSize], tallest: float) -> Array:
    """Shapes of blocks `(n, 3)`: edges along x and y, and how much the tallest block stands above [m]."""
    return np.array([(size.x, size.y, tallest - size.z) for size in sizes], dtype=float).reshape(-1, 3)


def outlines(poses: npt.ArrayLike, shapes: npt.ArrayLike, margin: float = 0.0) -> Array:
    """The blocks themselves, of shapes `(..., 3)`, grown by a margin [m], `(..., 6)`."""
    half = np.asarray(shapes)[..., :2] / 2 + margin
    return rectangles(poses, half[..., 0], half[..., 1])


def fingers(poses: npt.ArrayLike, shapes: npt.ArrayLike, gripper: GripperFootprint) -> Array:
    """Beside the faces that a grasp touches: `(..., grasp, finger, 6)` for both grasps and fingers."""
    shape = np.asarray(shapes)
    thickness = (gripper.slab_thickness + gripper.finger_taper * shape[..., 2])[..., None, None]
    reach = (shape[..., :2, None] + thickness) / 2 * np.array([1.0, -1.0])
    return rectangles(_turned(poses)[..., None, :], thickness / 2, gripper.slab_width / 2, reach)


def placings(poses: npt.ArrayLike, shapes: npt.ArrayLike, gripper: GripperFootprint) -> Array:
    """Fingers and block where it is put down, `(..., grasp, 3, 6)`."""
    beside = fingers(poses, shapes, gripper)
    # By whichever grasp, the block covers the same: its own rectangle, not one turned with the gripper.
    block = np.broadcast_to(
        outlines(poses, shapes, gripper.block_margin)[..., None, None, :], (*beside.shape[:-2], 1, 6)
    )
    return np.concatenate([beside, block], axis=-2)


def too_wide(shapes: npt.ArrayLike, gripper: GripperFootprint) -> npt.NDArray[np.bool_]:
    """Which of both grasps the gripper does not open enough for, `(..., 2)`."""
    opening = np.asarray(shapes)[..., :2] + 2 * gripper.opening_clearance
    return np.asarray(opening > gripper.max_opening + SLACK)


def sweeps(
    ends: npt.ArrayLike, headings: npt.ArrayLike, distances: npt.ArrayLike, shapes: npt.ArrayLike,
    gripper: GripperFootprint,
) -> Array:  # fmt: skip
    """The whole room of pushes that end at poses `(..., 3)`, `(..., 6)`.

    From the gripper's rear where it comes down to the block's front where it stops; as wide as the block,
    behind which the almost closed gripper hides, unless the block is narrow.
    """
    pose, shape = np.array(ends, dtype=float), np.asarray(shapes)
    is_along_y = np.round((np.asarray(headings) - pose[..., 2]) / QUARTER) % 2 == 1
    along = np.where(is_along_y, shape[..., 1], shape[..., 0])
    across = np.where(is_along_y, shape[..., 0], shape[..., 1])
    pose[..., 2] = headings
    front = along / 2 + gripper.block_margin
    rear = np.asarray(distances) + along / 2 + gripper.push_tail
    gripper_half_width = gripper.push_width / 2 + gripper.finger_taper * shape[..., 2] + gripper.safety_margin
    half_width = np.maximum(across / 2 + gripper.block_margin, gripper_half_width)
    return rectangles(pose, (front + rear) / 2, half_width, (front - rear) / 2)


def _turned(poses: npt.ArrayLike) -> Array:
    """Poses `(..., 2, 3)` with x along the direction in which either grasp closes."""
    pose = np.asarray(poses, dtype=float)
    turned = np.stack([pose, pose], axis=-2)
    turned[..., 1, 2] += QUARTER
    return turned


def edges(corners: Sequence[Point]) -> Array:
    """Half planes `(edges, 3)`: a point p is inside where `n @ p <= d`, rows n_x, n_y, d."""
    points = np.array(corners, dtype=float)
    along = np.roll(points, -1, axis=0) - points
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1) * np.sign(signed_area(corners))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.column_stack([normals, np.sum(normals * points, axis=1)])


def signed_area(corners: Sequence[Point]) -> float:
    """Area [m^2] of a polygon, positive when its corners run counter-clockwise."""
    x, y = np.array(corners, dtype=float).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def is_convex(corners: Sequence[Point]) -> bool:
    """At least three corners, all on or inside every edge, and an area."""
    points = np.array(corners, dtype=float)
    if (
        len(points) < 3
        or np.all(points == np.roll(points, 1, axis=0), axis=1).any()
        or abs(signed_area(corners)) < 1e-9
    ):
        return False
    half_planes = edges(corners)
    return bool(np.all(half_planes[:, :2] @ points.T <= half_planes[:, 2:] + SLACK))


def corners_of(poses: Array, shapes: npt.ArrayLike) -> Array:
    """Corners `(..., 4, 2)` of blocks of shapes `(..., 3)` at poses `(..., 3)`."""
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (np.asarray(shapes)[..., None, :2] / 2)
    cosine, sine = np.cos(poses[..., 2, None]), np.sin(poses[..., 2, None])
    x = poses[..., 0, None] + cosine * signs[..., 0] - sine * signs[..., 1]
    y = poses[..., 1, None] + sine * signs[..., 0] + cosine * signs[..., 1]
    return np.stack([x, y], axis=-1)


def are_inside(poses: Array, shapes: npt.ArrayLike, half_planes: Array) -> npt.NDArray[np.bool_]:
    """Blocks of shapes `(..., 3)` at poses `(..., 3)` stand inside with all corners `(...)`."""
    heights = corners_of(poses, shapes) @ half_planes[:, :2].T
    return np.asarray(np.all(heights <= half_planes[:, 2] + SLACK, axis=(-2, -1)))


def hits(footprints: Array, outlines: Array) -> Words:
    """Which blocks' outlines each footprint overlaps, as bits.

    Args:
        footprints: `(..., rectangles, 6)`, each the union of its rectangles.
        outlines: `(Q, 6)`

    Returns:
        Words `(..., ceil(Q / 64))`.
    """
    *shape, n, _ = footprints.shape
    flat = np.ascontiguousarray(footprints).reshape(-1, n, 6)
    words = hit_words(flat, np.ascontiguousarray(outlines))
    return words.reshape(*shape, words.shape[-1])


@njit(cache=True)
def hit_words(footprints: Array, outlines: Array) -> Words:
    """`hits` of footprints `(F, rectangles, 6)`."""
    count = (outlines.shape[0] + BITS - 1) // BITS
    words = np.zeros((footprints.shape[0], count), dtype=np.uint64)
    for f in range(footprints.shape[0]):
        for r in range(footprints.shape[1]):
            for q in range(outlines.shape[0]):
                if overlap(footprints[f, r], outlines[q]):
                    words[f, q // BITS] |= np.uint64(1) << np.uint64(q % BITS)
    return words


@njit(cache=True, inline="always")
def overlap(a: Array, b: Array) -> bool:
    """Two rectangles have more than their outlines in common."""
    x, y = b[0] - a[0], b[1] - a[1]
    reach = a[4] + a[5] + b[4] + b[5]
    if x * x + y * y > reach * reach:
        return False
    cosine, sine = abs(a[2] * b[2] + a[3] * b[3]), abs(a[2] * b[3] - a[3] * b[2])
    return bool(
        abs(x * a[2] + y * a[3]) + TOUCH < a[4] + b[4] * cosine + b[5] * sine
        and abs(y * a[2] - x * a[3]) + TOUCH < a[5] + b[4] * sine + b[5] * cosine
        and abs(x * b[2] + y * b[3]) + TOUCH < b[4] + a[4] * cosine + a[5] * sine
        and abs(y * b[2] - x * b[3]) + TOUCH < b[5] + a[4] * sine + a[5] * cosine
    )


@njit(cache=True, inline="always")
def is_free(footprint: Words, occupied: Words) -> bool:
    """The footprint hits none of the spots that are occupied, both `(words,)`."""
    hit = np.uint64(0)
    for w in range(occupied.shape[0]):
        hit |= footprint[w] & occupied[w]
    return bool(hit == 0)
