"""Messages of the palletizing cell to values and back: detections, gripper, layouts, scans, sightings."""

from __future__ import annotations

from array import array

import numpy as np
from pack_interfaces.msg import BoardSighting as BoardSightingMsg
from pack_interfaces.msg import BoxDetection as BoxDetectionMsg
from pack_interfaces.msg import ExpectedBox as ExpectedBoxMsg
from pack_interfaces.msg import GripperState, LayoutBox
from pack_interfaces.srv import PlanLayout
from sensor_msgs.msg import PointCloud2, PointField

from pack_core.errors import MessageError
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD, BoardSighting
from pack_core.palletizing.grip import GripLoad, GripState
from pack_core.palletizing.orders.layout_plan import Insertion, LayoutPlan, LayoutStatus, PlannedBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.scanner import PlaceScan, scanner_frame
from pack_core.ros.messages.conversions import (
    WORLD,
    finite,
    from_pose,
    from_stamp,
    from_vector,
    to_point,
    to_pose,
    to_stamp,
    to_vector,
)

POINT_FIELDS = tuple(
    PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1) for i, name in enumerate("xyz")
)
"""Of the points of a scan: x, y and z [m]."""
POINT_STEP = 12
"""Bytes of a point: three floats."""
NEAREST_POINT = 0.1
"""No scanner measures what is nearer than this [m]."""
MOST_POINTS = 100_000
"""Points of a scan at most: comparing more would hold the machine up."""


def to_expected_box(box: ExpectedBox) -> ExpectedBoxMsg:
    """A message of the expected box."""
    message = ExpectedBoxMsg(id=box.id, size=to_vector(box.dims))
    message.header.stamp = to_stamp(box.time)
    return message


def from_expected_box(message: ExpectedBoxMsg) -> ExpectedBox:
    """The expected box in a message; MessageError where its size must not be used."""
    d_x, d_y, d_z = from_vector(message.size, f"size of box '{message.id}'").tolist()
    if not d_x >= d_y >= d_z > 0.0:
        raise MessageError(f"size of box '{message.id}' is {[d_x, d_y, d_z]}; allowed: d_x >= d_y >= d_z > 0")
    return ExpectedBox(message.id, (d_x, d_y, d_z), from_stamp(message.header.stamp))


def to_detection(detection: BoxDetection) -> BoxDetectionMsg:
    """A message of what was detected, or of why nothing was."""
    message = BoxDetectionMsg(
        box_id=detection.box_id, status=int(detection.status), reason=detection.reason, size=detection.size
    )
    message.header.stamp, message.header.frame_id = to_stamp(detection.time), WORLD
    if detection.X_WB is not None and detection.X_WT is not None:
        message.pose, message.grasp = to_pose(detection.X_WB), to_pose(detection.X_WT)
    return message


def from_detection(message: BoxDetectionMsg) -> BoxDetection:
    """What a message says of a picture; MessageError where a value must not be used."""
    if message.status not in list(DetectionStatus):
        raise MessageError(f"status is {message.status}; allowed: {[s.value for s in DetectionStatus]}")
    status = DetectionStatus(message.status)
    is_detected = status is DetectionStatus.DETECTED
    length, width = finite(message.size, f"size of box '{message.box_id}'").tolist()
    return BoxDetection(
        from_stamp(message.header.stamp), message.box_id, status, message.reason,
        from_pose(message.pose) if is_detected else None, from_pose(message.grasp) if is_detected else None,
        (length, width),
    )  # fmt: skip


def to_gripper_state(time: float, state: GripState) -> GripperState:
    """A message of a gripper's state at `time` [s].

    While it is still closing, `is_closed` is false and the reason empty.
    """
    message = GripperState(
        is_closed=state.is_closed, object=state.held, coaxial_force=state.load.coaxial,
        shear_force=state.load.shear, moment=state.load.moment, release_reason=state.reason,
    )  # fmt: skip
    message.header.stamp = to_stamp(time)
    return message


def from_gripper_state(message: GripperState) -> GripState:
    """The gripper's state in a message, which does not hold the peak load: the load stands for it.

    Raises:
        MessageError: a load is not finite.
    """
    values = finite([message.coaxial_force, message.shear_force, message.moment], "gripper state: load")
    load = GripLoad(*(float(value) for value in values))
    is_closing = not message.is_closed and not message.release_reason
    return GripState(message.object, is_closing, load, load, message.release_reason)


def fill_layout(response: PlanLayout.Response, plan: LayoutPlan) -> None:
    """Put a plan into a response."""
    response.status, response.message = int(plan.status), plan.reason
    response.gap, response.virtual_margin = plan.gap, plan.virtual_margin
    response.boxes = [_to_box(item) for item in plan.boxes]


def from_layout(response: PlanLayout.Response) -> LayoutPlan:
    """The plan in a response.

    Raises:
        MessageError: it must not be used.
    """
    if response.status not in list(LayoutStatus):
        raise MessageError(f"status is {response.status}; allowed: {[s.value for s in LayoutStatus]}")
    boxes = tuple(_from_box(item) for item in response.boxes)
    return LayoutPlan(
        LayoutStatus(response.status), response.message, boxes, response.gap, response.virtual_margin
    )


def _to_box(item: PlannedBox) -> LayoutBox:
    return LayoutBox(
        id=item.placed.id, lower=to_point(item.placed.lower), size=to_vector(item.placed.size),
        mass=float(item.placed.mass), direction=item.insertion.direction,
        outward=to_vector(item.insertion.outward), corridor=float(item.insertion.corridor),
    )  # fmt: skip


def _from_box(item: LayoutBox) -> PlannedBox:
    size = from_vector(item.size, f"size of box '{item.id}'")
    outward = from_vector(item.outward, f"direction of box '{item.id}'")
    lower = finite([item.lower.x, item.lower.y, item.lower.z], f"place of box '{item.id}'")
    finite([item.mass, item.corridor], f"mass or corridor of box '{item.id}'")
    return PlannedBox(
        PlacedBox(item.id, lower, size, item.mass), Insertion(item.direction, outward, item.corridor)
    )


def to_cloud(scan: PlaceScan) -> PointCloud2:
    """A message of a scan: its points in the frame of the scanner, in no particular order."""
    n = len(scan.points)
    message = PointCloud2(
        height=1,
        width=n,
        fields=list(POINT_FIELDS),
        point_step=POINT_STEP,
        row_step=POINT_STEP * n,
        is_dense=True,
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
    is_packed = list(message.fields) == list(POINT_FIELDS) and not message.is_bigendian
    if not is_packed or len(message.data) != POINT_STEP * n or not 0 < n <= MOST_POINTS:
        raise MessageError(
            f"{n} points in {len(message.data)} bytes with {len(message.fields)} fields; allowed: 1 to "
            f"{MOST_POINTS} points, x, y, z as little-endian floats, without padding"
        )
    points = finite(np.frombuffer(message.data, dtype="<f4").reshape(n, 3), "a scan's points")
    if np.any(np.linalg.norm(points, axis=1) < NEAREST_POINT):
        raise MessageError(f"a point nearer to the scanner than {NEAREST_POINT} m")
    return PlaceScan(from_stamp(message.header.stamp), place, points)


def to_sighting(sighting: BoardSighting) -> BoardSightingMsg:
    """A message of a sighting."""
    u, v = sighting.pixels.T.tolist()
    message = BoardSightingMsg(width=sighting.width, ids=sighting.ids.tolist(), u=u, v=v)
    message.header.stamp = to_stamp(sighting.time)
    return message


def from_sighting(message: BoardSightingMsg) -> BoardSighting:
    """The sighting in a message; MessageError where it must not be used."""
    ids, most = np.array(message.ids, dtype=int), len(CALIBRATION_BOARD.corners())
    pixels = [finite(values, f"corners, {name}") for name, values in (("u", message.u), ("v", message.v))]
    if not message.width or any(len(values) != len(ids) for values in pixels) or np.any(ids >= most):
        raise MessageError(
            f"{len(ids)} corners with {len(pixels[0])} u and {len(pixels[1])} v in a picture of width "
            f"{message.width}; allowed: as many of each, and numbers below {most}"
        )
    return BoardSighting(from_stamp(message.header.stamp), message.width, ids, np.column_stack(pixels))
