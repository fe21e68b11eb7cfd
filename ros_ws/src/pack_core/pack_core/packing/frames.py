"""Frames of the packing cell that stand still, for /tf_static."""

from __future__ import annotations

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.model import UPSIDE_DOWN
from pack_core.packing.scene import Container
from pack_core.rotations import Pose, from_matrix


def fixed_frames(cell: PackingCell, container: Container) -> dict[str, tuple[str, Pose]]:
    """X_PF and the parent's name P, by the name of frame F.

    Besides container and table there are two at the tool. `cup` is the cup's lip. `tip` is the frame of
    `/wrench`: the middle of the held object's top, with the axes of an object that hangs upright (what a
    compliant cup adds to that is left out). `mocap_camera_1` and so on look along z, with x to the right.
    """
    here = Pose(np.zeros(3))
    frames = {
        "table": ("world", here),
        "container": ("world", Pose(np.array([*container.centre, 0.0]))),
        "cup": ("tool", here),
        "tip": ("tool", Pose(np.zeros(3), np.array(UPSIDE_DOWN))),
    }
    for number, position in enumerate(cell.mocap.cameras, start=1):
        frames[f"mocap_camera_{number}"] = ("world", _looking_at(position, cell.mocap.target))
    return frames


def _looking_at(position: tuple[float, float, float], target: tuple[float, float, float]) -> Pose:
    """X_WC of a camera: z forward, x to the right and level, y down."""
    forward = np.subtract(target, position) / np.linalg.norm(np.subtract(target, position))
    right = np.cross(forward, [0.0, 0.0, 1.0])
    if np.linalg.norm(right) < 1e-9:  # it looks straight down, where every horizontal axis is level
        right = np.array([0.0, -1.0, 0.0])
    right = right / np.linalg.norm(right)
    R_WC = np.column_stack([right, np.cross(forward, right), forward])
    return Pose(np.array(position), from_matrix(R_WC))
