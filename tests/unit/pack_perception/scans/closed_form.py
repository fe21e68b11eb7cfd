"""Scans of blocks in closed form, with noise or without."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.scanner import PlaceScan
from pack_core.rotations import Array, Pose, from_yaw, multiply, rotate
from pack_perception.scans.rays import Rays


def scan_of(
    cell: PalletizingCell, place: str, blocks: Sequence[Obstacle], time: float = 0.0,
    noise: Array | float = 0.0,
) -> PlaceScan:  # fmt: skip
    """What the scanner over a place measures of some blocks on the floor."""
    X_WS, directions = cell.scanner_pose(place), cell.scanner_rays(place)
    rays_W = rotate(X_WS.q, directions)
    empty = Rays(X_WS.p, rays_W, np.zeros(len(rays_W)))
    floor = -X_WS.p[2] / rays_W[:, 2]
    distances = np.column_stack([empty.up_to(blocks), floor]).min(axis=1) + noise
    return PlaceScan(time, place, distances[:, None] * directions)


def box_on(level: float, x: float, y: float, size: Sequence[float], name: str = "box") -> Obstacle:
    """A box that stands on a level, its middle over (x, y)."""
    return Obstacle(name, Pose(np.array([x, y, level + 0.5 * size[2]])), np.array(size))


def moved(box: Obstacle, x: float = 0.0, y: float = 0.0, turn_deg: float = 0.0) -> Obstacle:
    """The box shifted, and turned about its own vertical."""
    q = multiply(from_yaw(np.deg2rad(turn_deg)), box.X_WO.q)
    return Obstacle(box.name, Pose(box.X_WO.p + np.array([x, y, 0.0]), q), box.size)
