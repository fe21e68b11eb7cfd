"""The arm's commanded state, moved step by step by the policies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.trajectory import JointState
from pack_motion.rmpflow.parameters import Policies
from pack_motion.rmpflow.spheres import Spheres
from pack_motion.rmpflow.tree import arm_arrays, pull_back
from pack_motion.rmpflow.tree_arrays import JointGoal, JointMotion
from pack_motion.tracking.config import MotionSet, Resolve
from pack_motion.tracking.joint_bounds import acceleration_bounds
from pack_motion.tracking.obstacle_field import ObstacleField
from pack_motion.tracking.resolve import resolve_capped, resolve_within


@dataclass(frozen=True)
class PolicyInputs:
    """What the policies depend on besides the reference: parameters, the arm's spheres, and obstacles."""

    policies: Policies
    spheres: Spheres
    field: ObstacleField


class Tracker:
    """Integrates the accelerations that the policies ask for.

    Args:
        arm: the arm that moves.
        config: how policies are resolved into accelerations.
        q: joint positions at the start, at rest `(n,)` [rad].
    """

    def __init__(self, arm: MotionArm, config: MotionSet, q: Array) -> None:
        self._arm, self._config, self._arrays = arm, config, arm_arrays(arm)
        self.state = JointState.at_rest(q)
        self.deviation = 0.0
        """Distance of the commanded tool from the reference [m]."""
        self.least_distance = np.inf
        """Smallest distance from any sphere of the arm to any obstacle that the policies react to [m]."""
        self.threat_speed = 0.0
        """Speed of the fastest of these obstacles [m/s]."""

    def step(
        self, h: float, start: JointState, end: JointState, q_posture: Array | None, seen: PolicyInputs
    ) -> None:
        """Advance by `h` [s] while the reference goes from `start` to `end`.

        Args:
            h: duration of the step [s].
            start: the reference at the start of the step.
            end: the reference at its end.
            q_posture: the posture that attracts the joints `(n,)` [rad]; None: that of the reference.
            seen: policies, spheres and obstacles.
        """
        self.threat_speed = seen.field.fastest
        n = max(int(np.ceil(h / self._config.substep - 1e-6)), 1)  # 1e-6: no extra substep from rounding
        a_ref = (end.v - start.v) / h
        for k in range(n):
            ahead = k * h / n
            q_ref = start.q + ahead * (start.v + 0.5 * ahead * a_ref)
            self._substep(h / n, q_ref, start.v + ahead * a_ref, a_ref, q_posture, seen)
        # The commanded acceleration is that of the reference at the end plus what the policies added to it;
        # the mean acceleration over the step would lag behind by half a step.
        correction = self.state.a - a_ref
        limit = self._arm.limits.acceleration
        if self._config.resolve is Resolve.WITHIN_LIMITS:
            a = np.clip(end.a + correction, -limit, limit)
            self.state = JointState(self.state.q, self.state.v, a)

    def _substep(
        self, h: float, q_ref: Array, v_ref: Array, a_ref: Array, q_posture: Array | None, seen: PolicyInputs
    ) -> None:
        q, v = self.state.q, self.state.v
        goal = JointGoal(q_ref, v_ref, a_ref, q_ref if q_posture is None else q_posture)
        M, f, self.deviation, self.least_distance = pull_back(
            self._arrays, JointMotion(q, v), goal, seen.spheres, seen.field.boxes, seen.policies
        )
        if self._config.resolve is Resolve.WITHIN_LIMITS:
            a = resolve_within(M, f, *acceleration_bounds(q, v, h, self._arm.limits))
            self.state = JointState(q + h * (v + 0.5 * h * a), v + h * a, a)
        else:
            a = resolve_capped(M, f, self._config.max_acceleration_norm)
            self.state = JointState(q + h * (v + h * a), v + h * a, a)
