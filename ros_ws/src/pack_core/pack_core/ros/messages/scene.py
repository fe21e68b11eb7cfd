"""Where the objects of a scene are, as messages and back."""

from __future__ import annotations

from pack_interfaces.msg import ObjectState as ObjectStateMsg
from pack_interfaces.msg import SceneState as SceneStateMsg

from pack_core.errors import MessageError
from pack_core.ros.messages.conversions import WORLD, from_pose, from_stamp, from_vector, to_stamp
from pack_core.states import ObjectState, SceneState, Source


def to_scene(state: SceneState) -> SceneStateMsg:
    """A message of all objects' states."""
    return SceneWriter().write(state)


class SceneWriter:
    """Makes messages of a scene again and again, in one message that it keeps.

    Building the message of ten objects anew takes three times as long as the physics between two of them.
    """

    def __init__(self) -> None:
        self._message = SceneStateMsg()
        self._message.header.frame_id = WORLD

    def write(self, state: SceneState) -> SceneStateMsg:
        """A message of all objects' states, which the next call overwrites."""
        message = self._message
        message.header.stamp = to_stamp(state.time)
        if len(message.objects) != len(state.objects):
            message.objects = [ObjectStateMsg() for _ in state.objects]
        for entry, (name, item) in zip(message.objects, state.objects.items(), strict=True):
            entry.name, entry.source, entry.age = name, int(item.source), float(item.age)
            _fill(entry, item)
        return message


def _fill(entry: ObjectStateMsg, item: ObjectState) -> None:
    p, o, v, w = entry.pose.position, entry.pose.orientation, entry.twist.linear, entry.twist.angular
    p.x, p.y, p.z = item.X_WO.p.tolist()
    o.w, o.x, o.y, o.z = item.X_WO.q.tolist()
    v.x, v.y, v.z = item.v_WO_W.tolist()
    w.x, w.y, w.z = item.w_WO_W.tolist()


def from_scene(message: SceneStateMsg) -> SceneState:
    """All objects' states in a message; MessageError where a value must not be used."""
    objects = {
        item.name: ObjectState(
            from_pose(item.pose), from_vector(item.twist.linear, f"velocity of {item.name}"),
            from_vector(item.twist.angular, f"angular velocity of {item.name}"),
            _source_of(item), item.age,
        )
        for item in message.objects
    }  # fmt: skip
    return SceneState(from_stamp(message.header.stamp), objects)


def _source_of(item: ObjectStateMsg) -> Source:
    if item.source not in list(Source):
        raise MessageError(f"source of {item.name} is {item.source}; allowed: {[s.value for s in Source]}")
    return Source(item.source)
