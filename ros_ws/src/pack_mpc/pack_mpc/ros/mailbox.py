"""Keeps the newest message of every kind; one that cannot be used never replaces a good one."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import WrenchStamped
from pack_interfaces.msg import GripperState
from pack_interfaces.msg import SceneState as SceneMessage
from sensor_msgs.msg import JointState

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.packing.scene import Scene
from pack_core.ros.clock import StampCheck
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import finite
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.scene import from_scene
from pack_core.ros.node import CellNode
from pack_core.ros.stream import Stream, StreamWait
from pack_core.states import SceneState
from pack_mpc.observation import PackingObservation, blind_for

SCENE_AGE = 0.1
"""Age beyond which an estimate of the scene is not planned from [s]: twelve frames of the cameras."""
JOINTS_WAIT = 0.05
"""Longest time for which the worker waits for a joint state [s of wall clock]: half the driver's watchdog."""
REPORT_PERIOD = 2.0
"""Time between two looks at what has come while nobody asks, so that bad messages are reported [s of wall
clock]."""
SCENES = 20
"""Scenes that may wait: those of 0.17 s, as only the newest is planned from."""
WRENCHES = 500
"""Wrenches that may wait: those of 2 s, as each counts for the force of a goal."""


class Mailbox:
    """Keeps what the worker plans from. Messages are looked at when somebody asks, not as they come.

    Every message that still waits is judged then. The oldest are dropped unseen where more came than may
    wait, as while no goal is pursued. All methods may be called from any thread.

    Args:
        node: whose messages are kept.
        joints: names of the arm's joints, in the order that joint states must have.

    Attributes:
        force: newest external force on cup or held object `(3,)` [N], in the axes of `/wrench`.
    """

    def __init__(self, node: CellNode, joints: Sequence[str]) -> None:
        self._node, self._joint_names = node, joints
        self._lock = threading.Lock()
        self._joint_stamps, self._scene_stamps = StampCheck(node), StampCheck(node)
        self._joints: JointSample | None = None
        self._observed: JointSample | None = None
        self._scene: SceneState | None = None
        self._is_held = True
        self.force = np.zeros(3)
        # bounded, as nobody fetches them while no goal is pursued
        self._forces: deque[float] = deque(maxlen=WRENCHES)
        joint_states = Stream(node, contracts.JOINT_STATES)
        self._new_joints = StreamWait(node, (joint_states,))
        self._streams: tuple[tuple[Stream, Callable[[Any], None]], ...] = (
            (joint_states, self._on_joints),
            (Stream(node, contracts.SCENE, depth=SCENES), self._on_scene),
            (Stream(node, contracts.WRENCH, depth=WRENCHES), self._on_wrench),
            (Stream(node, contracts.GRIPPER_STATE), self._on_gripper),
        )
        node.create_timer(REPORT_PERIOD, self.refresh, clock=node.wall)

    @property
    def joints(self) -> JointSample | None:
        """The newest joint state, if there is one."""
        self.refresh()
        return self._joints

    @property
    def is_held(self) -> bool:
        """Whether the pump holds an object, as last said."""
        self.refresh()
        return self._is_held

    @property
    def time(self) -> float:
        """Stamp of the newest joint state [s]."""
        joints = self.joints
        return joints.time if joints is not None else 0.0

    def wait_for_joints(self) -> bool:
        """Whether there is, within `JOINTS_WAIT`, a joint state that was not observed yet."""
        if self._joints is self._observed:
            self._new_joints.wait(JOINTS_WAIT)
            self.refresh()
        # A joint state that cannot be used is none: the driver stops an arm that nobody plans for.
        return self._joints is not self._observed

    def refresh(self) -> None:
        """Take all that has come; what cannot be used is counted and reported."""
        with self._lock:
            for stream, keep in self._streams:
                for message in stream.take_all():
                    self._node.guard(stream.contract, keep, message)

    def missing(self, scene: Scene) -> str:
        """What a goal cannot begin without and is still missing, in words; empty if nothing is.

        Other objects than the held one may be missing: the goal begins with a look for them.
        """
        self.refresh()
        if self._joints is None:
            return f"no {contracts.JOINT_STATES.name} yet: is sim up?"
        if self._scene is None:
            return f"no {contracts.SCENE.name} yet: is perception up?"
        held = scene.new_object.name
        return "" if held in self._scene.objects else f"the cameras have not seen {held} yet"

    def clear_forces(self) -> None:
        """Forget the forces noted so far, which belong to no goal."""
        self.refresh()
        with self._lock:
            self._forces.clear()

    def observe(self, blind_time: float) -> PackingObservation:
        """The newest of everything, with the forces since the last call.

        Args:
            blind_time: for how long the cameras may have seen nothing [s].

        Raises:
            MessageError: something is missing, or too old to plan from.
        """
        self.refresh()
        joints, scene = self._joints, self._scene
        self._observed = joints
        if joints is None or scene is None:
            raise MessageError("no joint state or no scene yet")
        age = joints.time - scene.time
        if age > SCENE_AGE:
            raise MessageError(f"the newest scene is {age:.3f} s old; allowed: {SCENE_AGE} s")
        unseen = blind_for(scene, joints.time)
        if unseen > blind_time:
            raise MessageError(
                f"the cameras have seen nothing for {unseen:.1f} s; allowed: {blind_time} s. The arm holds"
            )
        with self._lock:
            forces = np.array(self._forces)
            self._forces.clear()
        return PackingObservation(joints, scene, forces, self._is_held)

    def _on_joints(self, message: JointState) -> None:
        sample = from_joint_state(message, self._joint_names)
        self._joint_stamps.check(sample.time)
        self._joints = sample

    def _on_scene(self, message: SceneMessage) -> None:
        scene = from_scene(message)
        self._scene_stamps.check(scene.time)
        self._scene = scene

    def _on_wrench(self, message: WrenchStamped) -> None:
        force = message.wrench.force
        self.force = finite([force.x, force.y, force.z], "force")
        self._forces.append(float(np.linalg.norm(self.force)))

    def _on_gripper(self, message: GripperState) -> None:
        self._is_held = message.is_closed
