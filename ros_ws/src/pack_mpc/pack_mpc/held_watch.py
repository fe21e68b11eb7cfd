"""Whether the pump holds what the description says, told by the wrench while nothing else is touched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.joints import JointSample
from pack_core.kinematics.chain import SerialChain, chain_from_model
from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import PackingExitReason
from pack_core.packing.model import describe_robot, held_pose
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, to_matrix
from pack_core.states import SceneState
from pack_mpc.load_estimate import LoadConfig, LoadEstimate
from pack_mpc.observation import PackingObservation

CLEARANCE = 0.01
"""By how much the held object is above everything else where its wrench tells its mass [m]."""
GAP = 0.1
"""Samples that are farther apart are no neighbours [s]: the arm may have been stopped in between."""


@dataclass(frozen=True)
class LoadFault:
    """What is wrong with the load, how a goal ends for it, and in words."""

    reason: PackingExitReason
    message: str


def arm_chain(cell: PackingCell) -> SerialChain:
    """The cell's arm with its cup, the body `tool`."""
    return chain_from_model(describe_robot(cell).model, cell.robot.arm.joints, "tool")


class HeldWatch:
    """Follows one held object from the first sample on.

    Args:
        arm: the arm with its cup.
        scene: the scene as described, with the object that the pump holds.
        config: what is known of the sensor.
    """

    def __init__(self, arm: SerialChain, scene: Scene, config: LoadConfig) -> None:
        item = scene.new_object
        X_TN = held_pose(scene)
        self._object, self._config, self._scene = arm.with_tool(X_TN), config, scene
        R_WN = self._object.R_WT
        p_WC = self._object.p_WT + R_WN @ item.centre_of_mass
        self._centre = SerialChain(arm.axes, arm.points, R_WN, p_WC)
        self._half_diagonal = float(np.linalg.norm(item.half_extents))
        self._estimate: LoadEstimate | None = None
        self._before: tuple[float, Array, Array] | None = None
        self._noted: float | None = None
        self._is_named = False

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects in the container; what is held is the same."""
        self._scene = scene

    def motion(self, joints: JointSample) -> tuple[Array, Array]:
        """R_WN `(3, 3)`, and the velocity of the object's centre of mass in the world `(3,)` [m/s]."""
        return self._object.forward_matrix(joints.q)[0], self._centre.jacobian(joints.q)[:3] @ joints.v

    def observe(self, seen: PackingObservation) -> LoadFault | None:
        """Take note of what was measured since the observation before; what is wrong is said once."""
        if self._config.certainty == 1.0:
            return None
        joints, forces = seen.joints, seen.forces
        R, v = self.motion(joints)
        before, self._before = self._before, (joints.time, R, v)
        if before is None or not len(forces) or not self._is_free(joints.q, seen.scene):
            return None
        interval = joints.time - before[0]
        if not 0.0 < interval < GAP:
            return None
        # The middle of the interval is where its mean force counts; R turns by a few mrad within it.
        R_NW = 0.5 * (R + before[1]).T
        elapsed = joints.time - (before[0] if self._noted is None else self._noted)
        if self._estimate is None:
            zeroed_for = np.inf if seen.zeroed is None else max(before[0] - seen.zeroed, 0.0)
            self._estimate = LoadEstimate(self._scene.new_object.mass, self._config, zeroed_for)
        self._estimate.update(forces.mean(axis=0), R_NW, (v - before[2]) / interval, elapsed)
        self._noted = joints.time
        return self._fault(self._estimate)

    def _fault(self, estimate: LoadEstimate) -> LoadFault | None:
        if self._is_named or estimate.wrong < self._config.certainty:
            return None
        self._is_named = True
        item, mass = self._scene.new_object, estimate.mass
        if estimate.empty > estimate.wrong - estimate.empty:
            return LoadFault(
                PackingExitReason.DETACHED,
                f"the pump reports a hold, but '{item.name}', of {item.mass:.2f} kg, does not hang from it",
            )
        return LoadFault(
            PackingExitReason.FAULT,
            f"the pump holds {mass:.2f} kg instead of '{item.name}', of {item.mass:.2f} kg",
        )

    def _is_free(self, q: Array, scene: SceneState) -> bool:
        """Whether the held object is above the container's walls and everything that was seen."""
        tops = [
            float(state.X_WO.p[2]) + float(np.abs(to_matrix(state.X_WO.q)[2]) @ item.half_extents)
            for item in self._scene.objects
            if (state := scene.objects.get(item.name)) is not None
        ]
        lowest = float(self._object.forward_matrix(q)[1][2]) - self._half_diagonal
        return lowest > max([self._scene.container.height, *tops]) + CLEARANCE
