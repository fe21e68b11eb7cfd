"""Keeps the newest message of every kind; one that cannot be used never replaces a good one."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence

import numpy as np
from geometry_msgs.msg import WrenchStamped
from pack_interfaces.msg import GripperState
from pack_interfaces.msg import SceneState as SceneMessage
from sensor_msgs.msg import JointState

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.packing.scene import Scene
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.conversions import finite
from pack_core.ros.joint_messages import from_joint_state
from pack_core.ros.scene_messages import from_scene
from pack_core.states import SceneState
from pack_mpc.session import PackingObservation

SCENE_AGE = 0.1
"""Age beyond which an estimate of the scene is not planned from [s]."""


class Mailbox:
    """Keeps what the worker plans from; written by the executor, read by the worker.

    Args:
        node: whose messages are kept.
        joints: names of the arm's joints, in the order that joint states must have.
    """

    def __init__(self, node: CellNode, joints: Sequence[str]) -> None:
        self._joint_names = joints
        self._lock = threading.Lock()
        self.joints: JointSample | None = None
        self._scene: SceneState | None = None
        self._is_held = True
        self._forces: list[float] = []
        self.on_joints: Callable[[], None] = lambda: None
        node.listen(contracts.JOINT_STATES, self._on_joints)
        node.listen(contracts.SCENE, self._on_scene)
        node.listen(contracts.WRENCH, self._on_wrench)
        node.listen(contracts.GRIPPER_STATE, self._on_gripper)

    @property
    def time(self) -> float:
        """Stamp of the newest joint state [s]."""
        return self.joints.time if self.joints is not None else 0.0

    def missing(self, scene: Scene) -> str:
        """What is still missing of the joints and the objects of the scene, in words; empty if nothing is."""
        if self.joints is None:
            return f"no {contracts.JOINT_STATES.name} yet: is sim up?"
        if self._scene is None:
            return f"no {contracts.SCENE.name} yet: is perception up?"
        unseen = [name for name in (*scene.names, scene.new_object.name) if name not in self._scene.objects]
        return f"the cameras have not seen {', '.join(unseen)} yet" if unseen else ""

    def clear_forces(self) -> None:
        """Forget the forces noted so far, which belong to no goal."""
        with self._lock:
            self._forces.clear()

    def observe(self) -> PackingObservation:
        """The newest of everything, with the forces since the last call.

        Raises:
            MessageError: something is missing, or too old to plan from.
        """
        joints, scene = self.joints, self._scene
        if joints is None or scene is None:
            raise MessageError("no joint state or no scene yet")
        age = joints.time - scene.time
        if age > SCENE_AGE:
            raise MessageError(f"the newest scene is {age:.3f} s old; allowed: {SCENE_AGE} s")
        with self._lock:
            forces, self._forces = np.array(self._forces), []
        return PackingObservation(joints, scene, forces, self._is_held)

    def _on_joints(self, message: JointState) -> None:
        self.joints = from_joint_state(message, self._joint_names)
        self.on_joints()

    def _on_scene(self, message: SceneMessage) -> None:
        self._scene = from_scene(message)

    def _on_wrench(self, message: WrenchStamped) -> None:
        force = message.wrench.force
        magnitude = float(np.linalg.norm(finite([force.x, force.y, force.z], "force")))
        with self._lock:
            self._forces.append(magnitude)

    def _on_gripper(self, message: GripperState) -> None:
        self._is_held = message.is_closed
