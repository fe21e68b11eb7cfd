"""What the controller plans from: the newest of every message, with all forces in between."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence

import numpy as np
from pack_interfaces.msg import SceneState as SceneMessage

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.packing.scene import Scene
from pack_core.ros.clock import AHEAD, StampCheck
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_stamp, stamp_in
from pack_core.ros.messages.scene import from_scene
from pack_core.ros.messages.serialized import JointStateReader, WrenchReader
from pack_core.ros.newest_messages import Kept, NewestMessages
from pack_core.ros.node import CellNode
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_mpc.observation import PackingObservation, blind_for

SCENE_AGE = 0.1
"""Age beyond which an estimate of the scene is not planned from [s]: twelve frames of the cameras."""
JOINTS_WAIT = 0.05
"""Longest time for which the worker waits for a joint state [s of wall clock]: half the driver's watchdog."""
PERIOD = 0.024
"""Least time from one joint state that is planned from to the next [s]: half the latency that is planned for
at first. At real time an iteration takes about as long; where time runs slowly it keeps the controller from
planning several times as often, which the arm would not move better for."""
REPORT_PERIOD = 2.0
"""Time between two checks of what has come while nobody asks, so that bad messages are reported [s of wall
clock]."""
SOON = 0.1
"""A wrench that is stamped later than the joints by more belongs to another clock, and counts at once [s]."""
NEWEST = 1
"""Messages that may wait of what only the newest is planned from."""
WRENCHES = 500
"""Wrenches that may wait: those of 2 s, as each counts for the force of a goal."""


class Mailbox(NewestMessages):
    """Keeps what the worker plans from. Messages are looked at when somebody asks, not as they come.

    Of all but the forces only the newest message waits, and those before it are dropped unseen. Of the
    forces the oldest are, where more came than may wait, as while no goal is pursued. All methods may be
    called from any thread.

    Args:
        node: whose messages are kept.
        joints: names of the arm's joints, in the order that joint states must have.
    """

    def __init__(self, node: CellNode, joints: Sequence[str]) -> None:
        self._joint_reader, self._wrench_reader = JointStateReader(joints), WrenchReader()
        self._joint_stamps, self._scene_stamps = StampCheck(node), StampCheck(node)
        self._observed: JointSample | None = None
        # by their stamps [s]; bounded, as nobody fetches them while no goal is pursued
        self._forces: deque[tuple[float, Array]] = deque(maxlen=WRENCHES)
        super().__init__(
            node,
            (
                Kept(contracts.SCENE, self._to_scene, NEWEST),
                Kept(contracts.WRENCH, self._to_force, WRENCHES, raw=True),
                Kept(contracts.WRENCH_ZEROED, lambda message: from_stamp(message.stamp)),
                Kept(contracts.GRIPPER_STATE, lambda message: message.is_closed, NEWEST),
                Kept(contracts.JOINT_STATES, self._to_joints, NEWEST, raw=True),
            ),
        )
        node.create_timer(REPORT_PERIOD, self.refresh, clock=node.wall)

    @property
    def joints(self) -> JointSample | None:
        """The newest joint state, if there is one."""
        self.refresh()
        return self._joints

    @property
    def force(self) -> Array:
        """Newest external force on cup or held object `(3,)` [N], in the axes of `/wrench`."""
        force: Array | None = self[contracts.WRENCH]
        return np.zeros(3) if force is None else force

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
        """Whether there is, within `JOINTS_WAIT`, a joint state to plan from: `PERIOD` after the last one."""
        deadline = time.monotonic() + JOINTS_WAIT
        while not self._is_due and (left := deadline - time.monotonic()) > 0.0:
            self.wait(left)
            self.refresh()
        # A joint state that cannot be used is none: the driver stops an arm that nobody plans for.
        return self._is_due

    def missing(self, scene: Scene) -> str:
        """What a goal cannot begin without and is still missing, in words; empty if nothing is.

        Other objects than the held one may be missing: the goal begins with a look for them.
        """
        self.refresh()
        if self._joints is None:
            return f"no {contracts.JOINT_STATES.name} yet: is sim up?"
        if (seen := self._scene) is None or self._joints.time < seen.time - AHEAD:
            return f"no {contracts.SCENE.name} yet: is perception up?"
        held = scene.new_object.name
        return "" if held in seen.objects else f"the cameras have not seen {held} yet"

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
        if age < -AHEAD:
            raise MessageError("the newest scene is from before time began anew")
        unseen = blind_for(scene, joints.time)
        if unseen > blind_time:
            raise MessageError(
                f"the cameras have seen nothing for {unseen:.1f} s; allowed: {blind_time} s. The arm holds"
            )
        # Wrenches are looked at before joints: those of just before these joints have come meanwhile.
        self.refresh()
        forces = self._forces_until(joints.time)
        return PackingObservation(joints, scene, forces, self._is_held, self._zeroed_by(joints.time))

    def _forces_until(self, time: float) -> Array:
        """The forces `(n, 3)` [N] since the last call; those measured shortly after `time` [s] wait.

        What is held is judged by what it accelerates with between two joint states, and the forces meanwhile.
        """
        with self._lock:
            noted = list(self._forces)
            self._forces.clear()
            self._forces.extend(one for one in noted if time < one[0] <= time + SOON)
        forces = [force for stamp, force in noted if not time < stamp <= time + SOON]
        return np.array(forces).reshape(-1, 3)

    @property
    def _is_due(self) -> bool:
        joints, before = self._joints, self._observed
        if joints is None or before is None:
            return joints is not before
        since = joints.time - before.time
        return since >= PERIOD or since < 0.0  # the simulator has begun anew

    @property
    def _joints(self) -> JointSample | None:
        joints: JointSample | None = self[contracts.JOINT_STATES]
        return joints

    @property
    def _scene(self) -> SceneState | None:
        scene: SceneState | None = self[contracts.SCENE]
        return scene

    @property
    def _is_held(self) -> bool:
        is_closed: bool | None = self[contracts.GRIPPER_STATE]
        return is_closed is not False  # held until the gripper says otherwise

    def _zeroed_by(self, time: float) -> float | None:
        """When the force sensor was set to zero [s]; None if nobody said, or before the driver began anew."""
        zeroed: float | None = self[contracts.WRENCH_ZEROED]
        return zeroed if zeroed is not None and zeroed <= time else None

    def _to_joints(self, data: bytes) -> JointSample:
        sample = self._joint_reader.read(data)
        self._joint_stamps.check(sample.time)
        return sample

    def _to_scene(self, message: SceneMessage) -> SceneState:
        scene = from_scene(message)
        self._scene_stamps.check(scene.time)
        return scene

    def _to_force(self, data: bytes) -> Array:
        force = self._wrench_reader.read(data)
        self._forces.append((stamp_in(data), force))
        return force
