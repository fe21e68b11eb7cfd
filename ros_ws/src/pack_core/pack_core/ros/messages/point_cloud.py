"""Points as messages: x, y and z as little-endian floats, without padding."""

from __future__ import annotations

from array import array

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

from pack_core.camera import PinholeCamera
from pack_core.ros.messages.conversions import to_stamp
from pack_core.rotations import Array

POINT_FIELDS = tuple(
    PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1) for i, name in enumerate("xyz")
)
"""Of a point: x, y and z [m]."""
POINT_STEP = 12
"""Bytes of a point: three floats."""


def to_point_cloud(time: float, points: Array, frame: str) -> PointCloud2:
    """A message of points `(n, 3)` in no particular order, or `(height, width, 3)` as pixels have them [m].

    What is not finite was not measured.

    Args:
        time: of the measurement [s].
        points: in the frame `frame`.
        frame: its name on /tf.
    """
    height, width = points.shape[:-1] if points.ndim == 3 else (1, len(points))
    message = PointCloud2(
        height=height, width=width, fields=list(POINT_FIELDS), point_step=POINT_STEP,
        row_step=POINT_STEP * width, is_dense=points.ndim == 2,
    )  # fmt: skip
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    data = array("B")  # the only type that rclpy takes without checking every byte
    data.frombytes(points.astype("<f4").tobytes())
    message.data = data
    return message


def to_depth_cloud(time: float, depth: Array, camera: PinholeCamera, frame: str) -> PointCloud2:
    """A message of a depth image `(height, width)` [m] as points in the camera's frame, a row for each row.

    Where nothing was measured, at a depth of 0, the point is not a number, as `depth_image_proc` has it.
    """
    v, u = np.indices(depth.shape)
    z = np.where(depth > 0.0, depth, np.nan)
    x, y = (u - camera.c[0]) / camera.f * z, (v - camera.c[1]) / camera.f * z  # (u, v) = f (x, y) / z + c
    return to_point_cloud(time, np.stack([x, y, z], axis=-1), frame)
