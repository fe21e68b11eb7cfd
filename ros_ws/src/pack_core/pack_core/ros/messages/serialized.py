"""Messages that come hundreds of times a second, written and read straight in their serialised form (CDR).

Filling a message's fields and having rclpy convert them takes three times as long as the middleware needs to
send it. What stays the same, names and frames, is serialised once by rclpy, and only numbers are written
anew. `Publisher.publish` takes the bytes as it takes a message, and a listener cannot tell the difference.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import WrenchStamped
from pack_interfaces.msg import ObjectState as ObjectStateMsg
from pack_interfaces.msg import SceneState as SceneStateMsg
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from pack_core import stamps
from pack_core.joints import JointSample
from pack_core.ros.messages.conversions import ENCAPSULATION, STAMP, WORLD, finite, stamp_in
from pack_core.ros.messages.joints import from_joint_state
from pack_core.rotations import Array
from pack_core.states import SceneState

MARK = -7.3e301
"""Stands in a template where a block of numbers begins; no name or length looks like it."""
AFTER_STAMP = ENCAPSULATION + STAMP.size
"""Bytes of a serialised message with a header up to the header's frame."""
OBJECT = struct.Struct("<13dB7xd")
"""Of an object's state: pose xyz, xyzw, twist, source, and after its alignment the age."""
WRENCH = struct.Struct("<6d")
"""Of a wrench: force and torque."""


class Template:
    """A serialised message that begins with a stamp or a header, and whose numbers are overwritten.

    Args:
        message: with `MARK` as the first number of each block of numbers; the last block ends the message.
        layouts: of the blocks, one behind the other.

    Attributes:
        blocks: where each block begins [byte], and its layout.
    """

    def __init__(self, message: Any, *layouts: struct.Struct) -> None:
        # The layouts are little-endian, as every machine is that ROS 2 Jazzy supports.
        self._data = bytearray(serialize_message(message))
        self.blocks: list[tuple[int, struct.Struct]] = []
        mark, end = struct.pack("<d", MARK), 0
        for layout in layouts:
            offset = self._data.index(mark, end)
            self.blocks.append((offset, layout))
            end = offset + layout.size
        if self.blocks:
            # rclpy reserves a few bytes too many for lists in lists, which readers of recordings refuse.
            # They hold what the memory held before, which may be another template's mark.
            del self._data[end:]

    def filled(self, time: float, blocks: Sequence[Sequence[float]]) -> bytes:
        """The message of `time` [s] with these numbers in its blocks."""
        STAMP.pack_into(self._data, ENCAPSULATION, *stamps.split(time))
        for (offset, layout), numbers in zip(self.blocks, blocks, strict=True):
            layout.pack_into(self._data, offset, *numbers)
        return bytes(self._data)


class ClockWriter:
    """Writes ticks of the clock."""

    def __init__(self) -> None:
        self._template = Template(Clock())

    def write(self, time: float) -> bytes:
        """A serialised rosgraph_msgs/Clock of `time` [s]."""
        return self._template.filled(time, ())


def _joint_block(n: int) -> struct.Struct:
    """Layout of n positions, velocities and efforts, the latter two behind their lengths."""
    return struct.Struct(f"<{n}dI4x{n}dI4x{n}d")


class JointStateWriter:
    """Writes the measured joints of an arm.

    Args:
        names: of its joints, in the order of the samples.
    """

    def __init__(self, names: Sequence[str]) -> None:
        n = self._n = len(names)
        message = JointState(name=list(names), position=[MARK] + (n - 1) * [0.0])
        message.velocity = message.effort = n * [0.0]
        self._template = Template(message, _joint_block(n))

    def write(self, sample: JointSample) -> bytes:
        """A serialised sensor_msgs/JointState."""
        q, v, tau = sample.q.tolist(), sample.v.tolist(), sample.tau.tolist()
        return self._template.filled(sample.time, ((*q, self._n, *v, self._n, *tau),))


class JointStateReader:
    """Reads serialised joint states, of which one looks like the next but for its numbers.

    Args:
        names: of the joints, in the order in which the samples shall have them.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._names, self._known, self._values = names, b"", struct.Struct("")
        self._order: list[int] = []

    def read(self, data: bytes) -> JointSample:
        """The measured joints in a serialised sensor_msgs/JointState.

        Raises:
            MessageError: other joints, or values that are not finite.
        """
        start = len(data) - self._values.size
        if not self._known or data[AFTER_STAMP:start] != self._known:
            return self._learn(data)
        n, numbers = len(self._names), self._values.unpack_from(data, start)
        rows = np.array((numbers[:n], numbers[n + 1 : 2 * n + 1], numbers[2 * n + 2 :]))
        if numbers[n] != n or numbers[2 * n + 1] != n or not np.isfinite(rows).all():
            return self._learn(data)  # which says what is wrong
        return JointSample(stamp_in(data), *rows[:, self._order])

    def _learn(self, data: bytes) -> JointSample:
        """Read a message field by field, and note how those look that have the same joints."""
        message = deserialize_message(data, JointState)
        sample = from_joint_state(message, self._names)
        n = len(self._names)
        self._values = _joint_block(n)
        self._known = bytes(data[AFTER_STAMP : len(data) - self._values.size])
        self._order = [list(message.name).index(name) for name in self._names]
        return sample


class WrenchWriter:
    """Writes a force and a torque in a frame that stays the same.

    Args:
        frame: in which they are given.
    """

    def __init__(self, frame: str) -> None:
        message = WrenchStamped()
        message.header.frame_id, message.wrench.force.x = frame, MARK
        self._template = Template(message, WRENCH)

    def write(self, time: float, force: Array, torque: Array) -> bytes:
        """A serialised geometry_msgs/WrenchStamped of a force `(3,)` [N] and a torque `(3,)` [N m]."""
        return self._template.filled(time, ((*force.tolist(), *torque.tolist()),))


class WrenchReader:
    """Reads forces out of serialised wrenches, of which one looks like the next but for its numbers."""

    def __init__(self) -> None:
        self._known: bytes | None = None

    def read(self, data: bytes) -> Array:
        """The force `(3,)` [N] in a serialised geometry_msgs/WrenchStamped.

        Raises:
            MessageError: it is not finite.
        """
        start = len(data) - WRENCH.size
        frame = bytes(data[AFTER_STAMP:start])
        if frame == self._known and data[1] & 1:  # the second byte is odd in little-endian messages
            return finite(WRENCH.unpack_from(data, start)[:3], "force")
        self._known = frame
        vector = deserialize_message(data, WrenchStamped).wrench.force
        return finite([vector.x, vector.y, vector.z], "force")


class SceneWriter:
    """Writes where the objects of a scene are."""

    def __init__(self) -> None:
        self._names: tuple[str, ...] | None = None

    def write(self, state: SceneState) -> bytes:
        """A serialised pack_interfaces/SceneState."""
        names = tuple(state.objects)
        if names != self._names:
            self._names, self._template = names, _scene_template(names)
        blocks = []
        for item in state.objects.values():
            w, x, y, z = item.X_WO.q.tolist()
            blocks.append(
                (*item.X_WO.p.tolist(), x, y, z, w, *item.v_WO_W.tolist(), *item.w_WO_W.tolist(),
                 int(item.source), item.age)
            )  # fmt: skip
        return self._template.filled(state.time, blocks)


def _scene_template(names: Sequence[str]) -> Template:
    message = SceneStateMsg(objects=[ObjectStateMsg(name=name) for name in names])
    message.header.frame_id = WORLD
    for entry in message.objects:
        entry.pose.position.x = MARK
    return Template(message, *len(names) * [OBJECT])
