"""A small bag of a goal, written message by message: the arm stands still, the object is lowered."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import (
    Nodetype,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

from pack_bringup.recording.bag_writer import BagWriter
from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core import stamps
from pack_core.bag_topic import Topic
from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.seen_deviations import SEEN
from pack_core.robots.panda import PANDA
from pack_core.topics import REAL_TIME_FACTOR

TYPES = message_types()
TOPICS = {
    topics.DESCRIPTION: "std_msgs/msg/String",
    topics.SIM_DESCRIPTION: "std_msgs/msg/String",
    topics.DEPTH_INFOS[0]: "sensor_msgs/msg/CameraInfo",
    SEEN: "std_msgs/msg/String",
    topics.MPC_STATUS: "pack_interfaces/msg/MpcStatus",
    topics.RESULT: "std_msgs/msg/String",
    topics.TRUTH: "pack_interfaces/msg/SceneState",
    topics.SCENE: "pack_interfaces/msg/SceneState",
    topics.JOINT_STATES: "sensor_msgs/msg/JointState",
    topics.WRENCH: "geometry_msgs/msg/WrenchStamped",
    topics.GRIPPER_STATE: "pack_interfaces/msg/GripperState",
    REAL_TIME_FACTOR: "std_msgs/msg/Float64",
    topics.SETTLED_SAMPLES: "pack_interfaces/msg/SettledSamples",
    topics.FILL_PROGRESS: "std_msgs/msg/String",
    topics.FILL_RESULT: "std_msgs/msg/String",
}
HEIGHTS = (0.30, 0.10)
"""Of the held object over its packing pose when the goal begins and when it ends [m]."""
TARGET = (0.5, 0.0, 0.09)
OUTCOME = {"exit_reason": "placed", "success": True, "message": "within 15 mm", "execution_time": 1.0}
STAGES = ("PRE_PACK", "INSERT", "FINE_TUNE")


def make(name: str, /, **fields: Any) -> Any:
    """A message of the bag's own types; fields that are not given are zero or empty."""
    zeros = {field: _zero(*kind) for field, kind in TYPES.get_msgdef(name).fields}
    return TYPES.types[name](**{**zeros, **fields})


def _zero(kind: Nodetype, detail: Any) -> Any:
    if kind == Nodetype.NAME:
        return make(detail)
    if kind == Nodetype.BASE:
        return {"string": "", "bool": False}.get(detail[0], 0)
    (_, element), _ = detail
    return [] if element[0] == "string" else np.empty(0)


def header(time: float) -> Any:
    """A header with a stamp."""
    sec, nanosec = stamps.split(time)
    stamp = make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
    return make("std_msgs/msg/Header", stamp=stamp)


def pose(x: float, y: float, z: float) -> Any:
    """An upright pose."""
    return make(
        "geometry_msgs/msg/Pose",
        position=make("geometry_msgs/msg/Point", x=x, y=y, z=z),
        orientation=make("geometry_msgs/msg/Quaternion", w=1.0),
    )


def write_bag(folder: Path, messages: Sequence[tuple[float, str, Any]]) -> None:
    """A whole bag of messages of any cell: when each was recorded [s], on which topic, and what it is."""
    types = {topic: message.__msgtype__ for _, topic, message in messages}
    bag = BagWriter(folder / "bag", [_topic(*item) for item in types.items()], TYPES, float("inf"))
    for time, topic, message in messages:
        data = TYPES.serialize_cdr(message, message.__msgtype__)
        bag.write(topic, stamps.to_ns(time), bytes(data))
    bag.close()


def _topic(name: str, type_name: str) -> Topic:
    latched = QosDurability.TRANSIENT_LOCAL if name == topics.DESCRIPTION else QosDurability.VOLATILE
    forever = QosTime(9223372036, 854775807)
    qos = Qos(
        QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, latched, forever, forever, QosLiveliness.AUTOMATIC,
        forever, avoid_ros_namespace_conventions=False,
    )  # fmt: skip
    return Topic(name, type_name, (qos,))


class GoalWriter:
    """Writes goals of one second each; topics that are left out stay empty.

    Args:
        folder: the run's folder.
        without: topics that are left out.
        chunk: messages a chunk of the bag; None: one chunk. By number, not by time as the recorder has it, so
            that the same bag comes of it however busy the machine is.
    """

    def __init__(self, folder: Path, *, without: tuple[str, ...] = (), chunk: int | None = None) -> None:
        self._bag = BagWriter(folder / "bag", [_topic(*item) for item in TOPICS.items()], TYPES, float("inf"))
        self._without, self._chunk, self._written = without, chunk, 0
        self._scene = packing_cell().scene
        self.write(0.0, topics.DESCRIPTION, data=self._scene.description().to_yaml())

    def write(self, time: float, topic: str, **fields: Any) -> None:
        """Write one message."""
        if topic not in self._without:
            data = TYPES.serialize_cdr(make(TOPICS[topic], **fields), TOPICS[topic])
            self._bag.write(topic, stamps.to_ns(time), bytes(data))
            self._written += 1
            if self._chunk and self._written % self._chunk == 0:
                self._bag.flush()

    def write_goal(self, start: float, outcome: dict[str, Any] | None = None) -> None:
        """A goal accepted at `start`: iterations of 20 ms, forces of 0, 1 and 2 N in turn."""
        for k in range(101):
            time, height = start + 0.01 * k, HEIGHTS[0] + 0.01 * k * (HEIGHTS[1] - HEIGHTS[0])
            self._write_sensors(time, height, float(k % 3))
            if k % 10 == 0 and k:
                stage = STAGES[min(k // 40, 2)]
                target = pose(*TARGET)
                self.write(
                    time, topics.MPC_STATUS, header=header(time), stage=stage, elapsed=0.01 * k,
                    target=target, iteration_ms=20.0, placements=1,
                )  # fmt: skip
        if outcome is not None:
            self.write(start + 1.0, topics.RESULT, data=json.dumps(outcome))

    def close(self) -> None:
        """Finish the bag."""
        self._bag.close()

    def _write_sensors(self, time: float, height: float, force: float) -> None:
        places = {name: (0.4 + 0.05 * i, 0.0, 0.06) for i, name in enumerate(self._scene.names)}
        places[self._scene.new_object.name] = (TARGET[0], TARGET[1], TARGET[2] + height)
        self.write_cell(time, places, force)
        self.write(time, REAL_TIME_FACTOR, data=0.5)

    def write_cell(self, time: float, places: Mapping[str, Sequence[float]], force: float) -> None:
        """Upright objects at places `(3,)` [m], seen as they are, the arm's joints, and a force [N]."""
        objects = [
            make("pack_interfaces/msg/ObjectState", name=name, pose=pose(*p)) for name, p in places.items()
        ]
        for topic in (topics.TRUTH, topics.SCENE):
            self.write(time, topic, header=header(time), objects=objects)
        names, positions = list(PANDA.joints), np.full(7, time)
        self.write(time, topics.JOINT_STATES, header=header(time), name=names, position=positions)
        load = make("geometry_msgs/msg/Vector3", z=force)
        wrench = make("geometry_msgs/msg/Wrench", force=load)
        self.write(time, topics.WRENCH, header=header(time), wrench=wrench)
