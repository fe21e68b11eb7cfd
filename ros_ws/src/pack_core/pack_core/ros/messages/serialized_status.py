"""The status of a motion, written and read straight in its serialised form (CDR); see `serialized`."""

from __future__ import annotations

import math
import struct
from dataclasses import replace

import numpy as np
from pack_interfaces.msg import MotionStatus as MotionStatusMsg
from rclpy.serialization import deserialize_message

from pack_core.motion.target import MotionStatus
from pack_core.ros.messages.conversions import stamp_in
from pack_core.ros.messages.motion import from_status, to_status
from pack_core.ros.messages.serialized import AFTER_STAMP, MARK, Template
from pack_core.rotations import Pose

ERRORS, TOOL = struct.Struct("<4dI"), struct.Struct("<7d")
"""Of a status: what remains, the errors and the steps within tolerance; and the tool's pose, xyz and xyzw."""


class MotionStatusWriter:
    """Writes where a move stands. From one status to the next mostly numbers change, and words seldom."""

    def __init__(self) -> None:
        self._words: tuple[object, ...] = ()

    def write(self, status: MotionStatus) -> bytes:
        """A serialised pack_interfaces/MotionStatus."""
        words = (status.id, status.state, status.segment, status.label, status.reason)
        if words != self._words:
            self._words, self._template = words, _template(status)
        w, x, y, z = status.X_WT.q.tolist()
        errors = (
            status.remaining, status.position_error, status.orientation_error, status.path_error,
            status.reached_steps,
        )  # fmt: skip
        return self._template.filled(status.time, (errors, (*status.X_WT.p.tolist(), x, y, z, w)))


class MotionStatusReader:
    """Reads serialised statuses, of which one looks like the next but for its numbers."""

    def __init__(self) -> None:
        self._words: tuple[bytes, bytes] | None = None

    def read(self, data: bytes) -> MotionStatus:
        """The status in a serialised pack_interfaces/MotionStatus.

        Raises:
            MessageError: it has values that must not be used.
        """
        if self._words is None or len(data) != self._length or self._words_in(data) != self._words:
            return self._learn(data)
        *errors, reached_steps = ERRORS.unpack_from(data, self._errors)
        p_x, p_y, p_z, x, y, z, w = tool = TOOL.unpack_from(data, self._tool)
        if not all(map(math.isfinite, tool)) or not 0.5 < math.hypot(w, x, y, z) < 2.0:
            return self._learn(data)  # which says what is wrong
        remaining, position, orientation, path = errors
        return replace(
            self._last, time=stamp_in(data), remaining=remaining, position_error=position,
            orientation_error=orientation, path_error=path, reached_steps=reached_steps,
            X_WT=Pose(np.array((p_x, p_y, p_z)), np.array((w, x, y, z))),
        )  # fmt: skip

    def _words_in(self, data: bytes) -> tuple[bytes, bytes]:
        """What is no number of a status like the last one: all before its errors, and the reason."""
        return bytes(data[AFTER_STAMP : self._errors]), bytes(data[self._errors + ERRORS.size : self._tool])

    def _learn(self, data: bytes) -> MotionStatus:
        """Read a message field by field, and note how those look that have the same words."""
        status = self._last = from_status(deserialize_message(data, MotionStatusMsg))
        (self._errors, _), (self._tool, _) = _template(status).blocks
        self._length, self._words = len(data), self._words_in(data)
        return status


def _template(status: MotionStatus) -> Template:
    message = to_status(status)
    message.remaining = message.tool.position.x = MARK
    return Template(message, ERRORS, TOOL)
