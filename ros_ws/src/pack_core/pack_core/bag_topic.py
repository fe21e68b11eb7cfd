"""What a bag says about one of its topics; shared by those who write, read and play bags."""

from __future__ import annotations

from dataclasses import dataclass

from rosbags.interfaces import Qos


@dataclass(frozen=True)
class Topic:
    """A topic of a bag; `type` is a name like `sensor_msgs/msg/JointState`."""

    name: str
    type: str
    offered_qos: tuple[Qos, ...] = ()
