"""The arm's commanded state, moved step by step by the policies, within the limits of its joints."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numba
import numpy as np

from pack_core.robots.joint_properties import JointLimits
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.trajectory import JointState
from pack_motion.rmpflow.parameters import Policies
from pack_motion.rmpflow.spheres import Spheres
from pack_motion.rmpflow.tree import JointGoal, JointMotion, arm_arrays, pull_back
from pack_motion.tracking.config import MotionSet, Resolve
from pack_motion.tracking.obstacles import ObstacleField

BRAKING = 0.9
"""Share of the acceleration limit that is assumed for stopping before the end of a range."""
MARGIN = 1e-4
"""A joint is stopped this far before the end of its range [rad], so that a time step cannot overrun it."""


def acceleration_bounds(q: Array, v: Array, h: float, limits: JointLimits) -> tuple[Array, Array]:
    """Lowest and highest accelerations `(n,)` for a step of `h` [s].

    Between them the acceleration and velocity limits are kept, and every joint can still stop in its range.
    """
    bounds: tuple[Array, Array] = _bounds(
        q, v, h, limits.lower, limits.upper, limits.velocity, limits.acceleration
    )
    return bounds


@numba.njit(cache=True)
def _bounds(
    q: Array, v: Array, h: float, lower: Array, upper: Array, velocity: Array, acceleration: Array
) -> tuple[Array, Array]:
    fastest = np.minimum(velocity, _stoppable(upper - q, v, h, acceleration))
    slowest = -np.minimum(velocity, _stoppable(q - lower, -v, h, acceleration))
    lowest = np.minimum(np.maximum((slowest - v) / h, -acceleration), acceleration)
    highest = np.minimum(np.maximum((fastest - v) / h, -acceleration), acceleration)
    return np.minimum(lowest, highest), np.maximum(lowest, highest)


@numba.njit(cache=True)
def _stoppable(room: Array, v: Array, h: float, acceleration: Array) -> Array:
    """Highest speed w after the step from which a joint still stops within `room` [rad].

    The step itself covers h (v + w) / 2, stopping covers w^2 / (2 a): the result is the root of
    w^2 + a h w - 2 a left = 0, where `left` is the room less the part of the step that v covers.
    """
    a = BRAKING * acceleration
    left = np.maximum(room - MARGIN - 0.5 * h * v, 0.0)
    return -0.5 * a * h + np.sqrt(0.25 * (a * h) ** 2 + 2.0 * a * left)


PSEUDO_INVERSE_CUTOFF = 1e-8
"""Eigenvalues of M below this share of the largest count as zero."""


def resolve_within(M: Array, f: Array, lower: Array, upper: Array) -> Array:
    """Accelerations `(n,)` that minimise `a^T M a / 2 - f^T a` within bounds: a box-constrained QP."""
    n = len(f)
    scale = n / float(M.trace())  # makes the mean eigenvalue of M 1, and leaves the minimum where it is
    a = np.minimum(np.maximum(np.zeros(n), lower), upper)
    factor, index = np.zeros((n, n + 7)), np.zeros(n, dtype=np.int32)  # workspace of mju_boxQP, n x (n + 7)
    mujoco.mju_boxQP(a, factor, index, scale * M, -scale * f, lower, upper)
    return a


def resolve_capped(M: Array, f: Array, norm: float) -> Array:
    """`M^+ f`, scaled down to a largest norm [rad/s^2]: the resolve of RMPflow, which has no joint limits."""
    a = np.linalg.pinv(M, rcond=PSEUDO_INVERSE_CUTOFF, hermitian=True) @ f
    size = float(np.linalg.norm(a))
    return np.asarray(a if size <= norm else a * (norm / size))


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
            a = np.minimum(np.maximum(end.a + correction, -limit), limit)
            self.state = JointState(self.state.q, self.state.v, a)

    def _substep(
        self, h: float, q_ref: Array, v_ref: Array, a_ref: Array, q_posture: Array | None, seen: PolicyInputs
    ) -> None:
        q, v, limits = self.state.q, self.state.v, self._arm.limits
        is_within = self._config.resolve is Resolve.WITHIN_LIMITS
        # Without limits a joint may have made whole turns. The arm is where it was before them, and so is all
        # that policies on joints are about: posture and ends of ranges.
        felt = q if is_within else limits.unwound(q)
        goal = JointGoal(q_ref, v_ref, a_ref, q_ref if q_posture is None else q_posture)
        M, f, self.deviation, self.least_distance = pull_back(
            self._arrays, JointMotion(felt, v), goal, seen.spheres, seen.field.boxes, seen.policies
        )
        if is_within:
            a = resolve_within(M, f, *acceleration_bounds(q, v, h, limits))
            self.state = JointState(q + h * (v + 0.5 * h * a), v + h * a, a)
        else:
            a = resolve_capped(M, f, self._config.max_acceleration_norm)
            self.state = JointState(q + h * (v + h * a), v + h * a, a)
