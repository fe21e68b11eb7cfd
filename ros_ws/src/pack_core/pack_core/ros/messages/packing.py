"""Messages of the packing cell to values and back: motion capture frames, and the way in of a placement."""

from __future__ import annotations

from array import array

import numpy as np
from geometry_msgs.msg import Vector3
from pack_interfaces.msg import MocapMarkers
from pack_interfaces.srv import PlanPlacement

from pack_core.errors import MessageError
from pack_core.packing.entry import WayIn
from pack_core.packing.markers import MarkerFrame
from pack_core.ros.messages.conversions import WORLD, finite, from_stamp, to_stamp
from pack_core.rotations import Array

UNIT_TOLERANCE = 1e-3
"""How far the length of a direction may be from 1."""


def to_markers(frame: MarkerFrame) -> MocapMarkers:
    """A message of a motion capture frame."""
    message = MocapMarkers(objects=list(frame.objects))
    message.header.stamp, message.header.frame_id = to_stamp(frame.time), WORLD
    # rclpy looks at each element of a list, and takes an array as it is.
    message.object_index = array("B", frame.object_index.astype(np.uint8).tobytes())
    message.marker_index = array("B", frame.marker_index.astype(np.uint8).tobytes())
    message.positions = array("d", frame.p_WM.tobytes())
    message.cameras = array("B", frame.cameras.astype(np.uint8).tobytes())
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


def fill_way(response: PlanPlacement.Response, way: WayIn) -> None:
    """Write the way into the answer."""
    response.over.x, response.over.y = way.over.tolist()
    response.lean = way.lean
    response.back = [] if way.back is None else [way.back]


def from_way(response: PlanPlacement.Response) -> WayIn:
    """The way in of an answer.

    Raises:
        MessageError: the side, the tilt or the offset is not what it may be.
    """
    back = finite(response.back, "back")
    if np.any(back < 0.0):
        raise MessageError(f"back is {back[0]}; allowed: metres from 0 on, or none")
    lean = checked_lean(response.lean)
    return WayIn(from_over(response.over), lean, float(back[0]) if len(back) else None)


def checked_lean(lean: float) -> float:
    """The tilt [rad], if it is one.

    Raises:
        MessageError: it is not.
    """
    if not 0.0 <= lean < 0.5 * np.pi:
        raise MessageError(f"lean is {lean}; allowed: radians from 0 to below pi / 2")
    return lean


def from_over(over: Vector3) -> Array:
    """The horizontal direction `(2,)` in which the object leans at the entry.

    Raises:
        MessageError: it is neither a unit vector nor zero.
    """
    direction = finite([over.x, over.y], "over")
    length = float(np.linalg.norm(direction))
    if length > 0.0 and abs(length - 1.0) > UNIT_TOLERANCE:
        raise MessageError(f"over has a length of {length:.3f}; allowed: 1, or 0 for no side")
    return direction
