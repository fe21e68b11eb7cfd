"""Scans of the pallet and of table B as point clouds and back."""

from __future__ import annotations

from array import array

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

from pack_core.errors import MessageError
from pack_core.palletizing.scanner import PlaceScan, scanner_frame
from pack_core.ros.conversions import finite, from_stamp, to_stamp

FIELDS = tuple(
    PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1) for i, name in enumerate("xyz")
)
STEP = 12
"""Bytes of a point: three floats."""
NEAREST = 0.1
"""No scanner measures what is nearer than this [m]."""
MOST = 100_000
"""Points of a scan at most: comparing more would hold the machine up."""


def to_cloud(scan: PlaceScan) -> PointCloud2:
    """A message of a scan: its points in the frame of the scanner, in no particular order."""
    n = len(scan.points)
    message = PointCloud2(
        height=1, width=n, fields=list(FIELDS), point_step=STEP, row_step=STEP * n, is_dense=True
    )
    message.header.stamp, message.header.frame_id = to_stamp(scan.time), scanner_frame(scan.place)
    data = array("B")  # the only type that rclpy takes without checking every byte
    data.frombytes(scan.points.astype("<f4").tobytes())
    message.data = data
    return message


def from_cloud(message: PointCloud2, place: str) -> PlaceScan:
    """The scan of a place in a message.

    Raises:
        MessageError: it is of another scanner, has other fields, or a point that no scanner can measure.
    """
    frame, n = message.header.frame_id, message.width * message.height
    if frame != scanner_frame(place):
        raise MessageError(f"points in the frame '{frame}'; allowed: {scanner_frame(place)}")
    is_packed = list(message.fields) == list(FIELDS) and not message.is_bigendian
    if not is_packed or len(message.data) != STEP * n or not 0 < n <= MOST:
        raise MessageError(
            f"{n} points in {len(message.data)} bytes with {len(message.fields)} fields; allowed: 1 to "
            f"{MOST} points, x, y, z as little-endian floats, without padding"
        )
    points = finite(np.frombuffer(message.data, dtype="<f4").reshape(n, 3), "a scan's points")
    if np.any(np.linalg.norm(points, axis=1) < NEAREST):
        raise MessageError(f"a point nearer to the scanner than {NEAREST} m")
    return PlaceScan(from_stamp(message.header.stamp), place, points)
