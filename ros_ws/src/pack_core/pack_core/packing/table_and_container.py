"""What stands in the packing cell by itself: the table and the container's walls."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.packing.scene import Container


def add_table(spec: mujoco.MjSpec, friction: float, surroundings: bool) -> None:
    """Add the plane of the table, which is not drawn where `surroundings` draw a floor instead."""
    spec.worldbody.add_geom(
        name="table", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(1.0, 0.8, 0.1), condim=3,
        friction=(friction, 0.005, 0.0001),
        rgba=(0.5, 0.5, 0.5, 0.0 if surroundings else 1.0),
    )  # fmt: skip


def add_container(spec: mujoco.MjSpec, container: Container, friction: float) -> None:
    """Add the four walls, whose inner faces are as far apart as the container's size says."""
    # half extents, as MuJoCo's boxes take them
    (w, l), h, t = 0.5 * np.array(container.size), 0.5 * container.height, 0.5 * container.wall
    x, y = container.centre
    sides = {
        "wall_left": ((x, y + l + t), (w + 2 * t, t)), "wall_right": ((x, y - l - t), (w + 2 * t, t)),
        "wall_near": ((x - w - t, y), (t, l)), "wall_far": ((x + w + t, y), (t, l)),
    }  # fmt: skip
    for name, ((px, py), (sx, sy)) in sides.items():
        spec.worldbody.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, pos=(px, py, h), size=(sx, sy, h),
            friction=(friction, 0.005, 0.0001), condim=3, rgba=(0.25, 0.42, 0.62, 1.0),
        )  # fmt: skip
