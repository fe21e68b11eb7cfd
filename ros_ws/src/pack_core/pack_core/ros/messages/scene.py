"""Where the objects of a scene are, as messages and back."""

from __future__ import annotations

import math

from pack_interfaces.msg import ObjectState as ObjectStateMsg
from pack_interfaces.msg import SceneState as SceneStateMsg

from pack_core.errors import MessageError
from pack_core.ros.messages.conversions import (
    WORLD,
    from_pose,
    from_stamp,
    from_vector,
    to_pose,
    to_stamp,
    to_vector,
)
from pack_core.states import ObjectState, SceneState, Source


def to_scene(state: SceneState) -> SceneStateMsg:
    """A message of all objects' states."""
    message = SceneStateMsg(objects=[_to_object(name, item) for name, item in state.objects.items()])
    message.header.stamp, message.header.frame_id = to_stamp(state.time), WORLD
    return message


def _to_object(name: str, item: ObjectState) -> ObjectStateMsg:
    entry = ObjectStateMsg(name=name, pose=to_pose(item.X_WO), source=int(item.source), age=float(item.age))
    entry.twist.linear, entry.twist.angular = to_vector(item.v_WO_W), to_vector(item.w_WO_W)
    return entry


def from_scene(message: SceneStateMsg) -> SceneState:
    """All objects' states in a message; MessageError where a value must not be used."""
    objects = {
        item.name: ObjectState(
            from_pose(item.pose), from_vector(item.twist.linear, f"velocity of {item.name}"),
            from_vector(item.twist.angular, f"angular velocity of {item.name}"),
            _source_of(item), _age_of(item),
        )
        for item in message.objects
    }  # fmt: skip
    return SceneState(from_stamp(message.header.stamp), objects)


def _age_of(item: ObjectStateMsg) -> float:
    if not 0.0 <= item.age < math.inf:
        raise MessageError(f"age of {item.name} is {item.age}; allowed: from 0 on [s]")
    return float(item.age)


def _source_of(item: ObjectStateMsg) -> Source:
    if item.source not in list(Source):
        raise MessageError(f"source of {item.name} is {item.source}; allowed: {[s.value for s in Source]}")
    return Source(item.source)
