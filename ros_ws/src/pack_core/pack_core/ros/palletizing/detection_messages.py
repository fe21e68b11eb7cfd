"""Box vision's question and answer to messages and back."""

from __future__ import annotations

from pack_interfaces.msg import BoxDetection as BoxDetectionMsg
from pack_interfaces.msg import ExpectedBox as ExpectedBoxMsg

from pack_core.errors import MessageError
from pack_core.palletizing.box_detection import BoxDetection, DetectionStatus, ExpectedBox
from pack_core.ros.conversions import (
    WORLD,
    finite,
    from_pose,
    from_stamp,
    from_vector,
    to_pose,
    to_stamp,
    to_vector,
)


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
