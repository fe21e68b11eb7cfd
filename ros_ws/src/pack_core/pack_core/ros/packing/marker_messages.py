"""Motion capture frames to messages and back."""

from __future__ import annotations

import numpy as np
from pack_interfaces.msg import MocapMarkers

from pack_core.errors import MessageError
from pack_core.packing.markers import MarkerFrame
from pack_core.ros.conversions import WORLD, finite, from_stamp, to_stamp


def to_markers(frame: MarkerFrame) -> MocapMarkers:
    """A message of a motion capture frame."""
    message = MocapMarkers(objects=list(frame.objects))
    message.header.stamp, message.header.frame_id = to_stamp(frame.time), WORLD
    message.object_index = frame.object_index.astype(np.uint8).tolist()
    message.marker_index = frame.marker_index.astype(np.uint8).tolist()
    message.positions = frame.p_WM.ravel().tolist()
    message.cameras = frame.cameras.astype(np.uint8).tolist()
    return message


def from_markers(message: MocapMarkers) -> MarkerFrame:
    """The motion capture frame in a message; MessageError where its arrays do not belong together."""
    n = len(message.object_index)
    if not n == len(message.marker_index) == len(message.cameras) == len(message.positions) / 3:
        raise MessageError(f"marker arrays differ: {n} objects, {len(message.positions)} coordinates")
    index = np.array(message.object_index, dtype=int)
    if n and index.max() >= len(message.objects):
        raise MessageError(f"object_index {index.max()} but only {len(message.objects)} objects")
    return MarkerFrame(
        from_stamp(message.header.stamp), tuple(message.objects), index,
        np.array(message.marker_index, dtype=int),
        finite(message.positions, "marker position").reshape(n, 3), np.array(message.cameras, dtype=int),
    )  # fmt: skip
