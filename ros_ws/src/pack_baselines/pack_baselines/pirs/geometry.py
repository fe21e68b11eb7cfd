"""Which blocks an action at any pose would hit, compiled; sets of blocks are bits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.planar import QUARTER
from pack_core.rotations import Array
from pack_planner.rearrangement.footprints import overlap, too_wide

LINE = 1e-7
"""Poses count as being on one push line up to this [m, rad]."""


class Sizes(NamedTuple):
    """Of a block that is moved and of the gripper [m]; see GripperFootprint.

    Attributes:
        edges: of the block, along its own x and y.
        can_grasp: the gripper opens enough for the grasps along x and along y.
    """

    edges: tuple[float, float]
    can_grasp: tuple[bool, bool]
    block_margin: float
    slab_thickness: float
    slab_width: float
    gripper_half_width: float
    push_tail: float
    min_push: float
    max_push: float

    @classmethod
    def of(cls, shape: Array, gripper: GripperFootprint) -> Sizes:
        """The sizes of a block's shape `(3,)` and of a gripper, as floats that compiled code takes."""
        x, y, rise = shape.tolist()
        wide_x, wide_y = too_wide(shape, gripper).tolist()
        thicker = gripper.finger_taper * rise
        return cls(
            (x, y), (not wide_x, not wide_y), gripper.block_margin, gripper.slab_thickness + thicker,
            gripper.slab_width, gripper.push_width / 2 + thicker + gripper.safety_margin,
            gripper.push_tail, gripper.min_push, gripper.max_push,
        )  # fmt: skip


@njit(cache=True)
def hit_blocks(rectangle: Array, outlines: Array) -> np.uint64:
    """The blocks `(n, 6)` that a rectangle overlaps."""
    blocks = np.uint64(0)
    for q in range(outlines.shape[0]):
        if overlap(rectangle, outlines[q]):
            blocks |= np.uint64(1) << np.uint64(q)
    return blocks


@njit(cache=True)
def rectangle_at(pose: Array, turn: float, x: float, half_x: float, half_y: float) -> Array:
    """A rectangle whose centre lies at x along the heading of a pose turned by `turn`."""
    cosine, sine = np.cos(pose[2] + turn), np.sin(pose[2] + turn)
    return np.array([pose[0] + cosine * x, pose[1] + sine * x, cosine, sine, half_x, half_y])


@njit(cache=True)
def grasp_hits(pose: Array, grasp: int, sizes: Sizes, outlines: Array) -> np.uint64:
    """What the fingers of a grasp would hit."""
    reach = (sizes.edges[grasp] + sizes.slab_thickness) / 2
    blocks = np.uint64(0)
    for x in (reach, -reach):
        finger = rectangle_at(pose, grasp * QUARTER, x, sizes.slab_thickness / 2, sizes.slab_width / 2)
        blocks |= hit_blocks(finger, outlines)
    return blocks


@njit(cache=True)
def block_hits(pose: Array, sizes: Sizes, outlines: Array) -> np.uint64:
    """What a block that is put down would hit."""
    half_x, half_y = sizes.edges[0] / 2 + sizes.block_margin, sizes.edges[1] / 2 + sizes.block_margin
    return hit_blocks(rectangle_at(pose, 0.0, 0.0, half_x, half_y), outlines)


@njit(cache=True)
def push_hits(start: Array, end: Array, sizes: Sizes, outlines: Array) -> np.uint64:
    """What a push would hit."""
    heading = np.arctan2(end[1] - start[1], end[0] - start[0])
    is_along_y = abs(np.sin(heading - end[2])) > abs(np.cos(heading - end[2]))
    along, across = sizes.edges[1 if is_along_y else 0], sizes.edges[0 if is_along_y else 1]
    front = along / 2 + sizes.block_margin
    rear = np.hypot(end[0] - start[0], end[1] - start[1]) + along / 2 + sizes.push_tail
    half_width = max(across / 2 + sizes.block_margin, sizes.gripper_half_width)
    sweep = rectangle_at(end, heading - end[2], (front - rear) / 2, (front + rear) / 2, half_width)
    return hit_blocks(sweep, outlines)


@njit(cache=True)
def is_push(start: Array, end: Array, is_symmetric: bool, sizes: Sizes) -> bool:
    """A push could lead from one pose to the other: same yaw, along a face's normal, not too long."""
    turn = end[2] - start[2]
    period = QUARTER if is_symmetric else 2 * np.pi
    if abs((turn + period / 2) % period - period / 2) > LINE:
        return False
    dx, dy = end[0] - start[0], end[1] - start[1]
    cosine, sine = np.cos(end[2]), np.sin(end[2])
    along, across = abs(cosine * dx + sine * dy), abs(cosine * dy - sine * dx)
    return bool(min(along, across) < LINE and sizes.min_push <= max(along, across) <= sizes.max_push)


@njit(cache=True)
def is_inside(pose: Array, sizes: Sizes, half_planes: Array) -> bool:
    """A block at the pose stands inside the workspace."""
    cosine, sine = np.cos(pose[2]), np.sin(pose[2])
    for e in range(half_planes.shape[0]):
        nx, ny = half_planes[e, 0], half_planes[e, 1]
        reach = sizes.edges[0] / 2 * abs(nx * cosine + ny * sine)
        reach += sizes.edges[1] / 2 * abs(ny * cosine - nx * sine)
        if nx * pose[0] + ny * pose[1] + reach > half_planes[e, 2] + 1e-9:
            return False
    return True
