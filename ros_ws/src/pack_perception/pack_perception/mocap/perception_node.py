"""Perception as a ROS 2 node: markers or depth images, and joints in; the estimated scene out."""

from __future__ import annotations

import threading
from collections import deque
from functools import partial
from typing import Any

from pack_interfaces.msg import GripperState
from pydantic import Field, PositiveFloat
from std_msgs.msg import String

from pack_core.packing.cell import Perception
from pack_core.packing.scene import Scene
from pack_core.ros.clock import StampCheck
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import stamp_in
from pack_core.ros.messages.serialized import JointStateReader, SceneWriter
from pack_core.ros.node import CellNode
from pack_core.ros.packing import read_packing_cell
from pack_core.ros.run import run_node
from pack_core.ros.stream import Stream, StreamReader
from pack_core.states import SceneState, Source
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.mocap.rigid_body_fit import FitRefusal
from pack_perception.perception_config import PerceptionConfig
from pack_perception.ros.frame_sources import Frame, FrameSource, MarkerSource

JOINTS_DEPTH = 500
"""Joint states that may wait: those of 1 s."""


class PerceptionNodeConfig(PerceptionConfig):
    """Parameters of the node `perception`."""

    min_rate: PositiveFloat = Field(default=60.0, description="of /scene while no frames come [Hz]")


class PerceptionNode(CellNode):
    """Publishes the estimated scene after every frame, and at `min_rate` while none come.

    A thread reads what has come whenever a frame comes: the joint states up to it, and then the frame.
    """

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("perception", **kwargs)
        self._config = self.read_parameters(PerceptionNodeConfig)
        self._cell = read_packing_cell(self)
        self._estimator: HandOverEstimator | None = None
        self._published = -float("inf")
        self._frames: deque[Frame] = deque(maxlen=50)
        self._unused_frames = 0
        self._joint_stamps = StampCheck(self)
        self._scene, self._writer = self.advertise(contracts.SCENE), SceneWriter()
        self._lock = threading.Lock()
        self._joint_reader = JointStateReader(self._cell.robot.arm.joints)
        self._joints = Stream(self, contracts.JOINT_STATES, depth=JOINTS_DEPTH, raw=True)
        self._source = self._chosen_source()
        self._gripper = Stream(self, contracts.GRIPPER_STATE)
        self._is_handed_over = False
        self.listen(self._source.told, self._on_description)
        self._reader = StreamReader(self, self._source.streams, self._read, 1.0 / self._config.min_rate)
        self.watch(("sim",))

    def _chosen_source(self) -> FrameSource:
        """The kind of sensor that the cell has."""
        if self._cell.perception is Perception.MOCAP:
            return MarkerSource(self, self._cell, self._config)
        # Here: what fits shapes takes a second to load, which no node by markers shall wait for.
        from pack_perception.ros.depth_source import DepthSource

        return DepthSource(self, self._cell, self._config)

    @property
    def waits_for(self) -> str:
        return self._source.unknown(self._estimator)

    def destroy_node(self) -> None:
        """Stop reading, then the node."""
        self._reader.end()
        super().destroy_node()

    def _on_description(self, message: String) -> None:
        scene = Scene.from_yaml(message.data, self._source.told.name)
        with self._lock:
            # what was packed before is still where it was, whoever is handed over now
            if scene.is_handed_over and self._estimator is not None:
                self._estimator.change_scene(scene)
            else:
                self._estimator = self._source.begin(scene)
            self._is_handed_over = scene.is_handed_over
            self._start_over()
        self.tell_status()

    def _read(self) -> None:
        """Take all that has come, in the reader's thread."""
        with self._lock:
            # Frames first: the joint states of their time were sent before them, so that they are there.
            frames = self._source.take()
            if self._estimator is not None:
                self._frames.extend(frames)
            for joints in self._joints.take_all():
                self.guard(contracts.JOINT_STATES, self._on_joints, joints)
            self._use_frames()
            for state in self._gripper.take_all():
                self.guard(contracts.GRIPPER_STATE, self._on_gripper, state)

    def _on_gripper(self, message: GripperState) -> None:
        """Take note of what the pump grips or lets go; an object that hung from the start is seen to fall."""
        estimator = self._estimator
        if estimator is None or not self._is_handed_over or message.is_closed == estimator.is_held:
            return
        if message.is_closed:
            estimator.take_hold()
        else:
            estimator.let_go()

    def _start_over(self) -> None:
        self._frames.clear()
        self._published = -float("inf")

    def _on_joints(self, data: bytes) -> None:
        estimator, time = self._estimator, stamp_in(data)
        # The estimator uses every other joint state; what it does not want need not be deserialised.
        if estimator is None or not estimator.wants(time):
            return
        self._joint_stamps.check(time)
        advance = estimator.advance(self._joint_reader.read(data))
        if advance.is_restart:
            self._start_over()
            self.get_logger().info("time or the arm jumped: starting over")
        for name in advance.diverged:
            self.health.count("diverged", f"physics of '{name}' was put back")
        self._use_frames()
        if estimator.time + self._config.step - self._published > 1.0 / self._config.min_rate:
            self._publish(estimator)

    def _use_frames(self) -> None:
        """Correct the estimate by the frames for which the joint states have come."""
        estimator = self._estimator
        while estimator is not None and self._frames and not estimator.is_ahead(self._frames[0]):
            self.guard(
                self._source.streams[0].contract, partial(self._correct, estimator), self._frames.popleft()
            )

    def _correct(self, estimator: HandOverEstimator, frame: Frame) -> None:
        correction = self._source.correct(estimator, frame)
        self._unused_frames += correction.is_unused
        for name, refusal in correction.refused.items():
            if refusal is FitRefusal.RESIDUAL:
                self.health.count("refused fit", f"{refusal.value} '{name}'")
        for name in correction.mismatched:
            self.health.count("markers left out", f"some of '{name}' do not match the others")
        if not correction.is_unused:
            self._publish(estimator)

    def _publish(self, estimator: HandOverEstimator) -> None:
        if self._source.unknown(estimator):  # nobody could tell what the names stand for
            return
        state = estimator.state(estimator.time)
        self._published = state.time
        self._scene.publish(self._writer.write(state))
        self._note(state, estimator)

    def _note(self, state: SceneState, estimator: HandOverEstimator) -> None:
        hidden = [f"{n} {o.age:.1f} s" for n, o in state.objects.items() if o.source is Source.PHYSICS]
        unknown = [name for name in estimator.scene.names if name not in state.objects]
        self.health.values["carried by physics"] = ", ".join(hidden) or "none"
        self.health.values["not seen yet"] = ", ".join(unknown) or "none"
        self.health.values["frames too late"] = str(self._unused_frames)
        if estimator.is_held or self._is_handed_over:
            self.health.faults.pop("grip", None)
        else:
            name = estimator.scene.new_object.name
            self.health.faults["grip"] = f"'{name}' no longer hangs on the cup as it was gripped"


def main() -> int:
    """Entry point of `perception_node`."""
    return run_node(PerceptionNode)
