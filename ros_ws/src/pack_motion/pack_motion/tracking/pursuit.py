"""How the reference of the policies advances through a plan."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import JointState, ReferenceTrajectory
from pack_motion.tracking.config import MotionSet, Reference
from pack_motion.tracking.speed_separation import SpeedSeparationMonitor, Threat


class Pursuit(ABC):
    """One plan being followed."""

    def __init__(self, plan: MotionPlan) -> None:
        self.plan = plan
        self.segment = int(plan.trajectory.segment[0])
        self.rate = 1.0
        """Rate at which the reference advances; 1 is as planned."""

    @abstractmethod
    def advance(
        self, h: float, deviation: float, threat: Threat
    ) -> tuple[JointState, JointState, Array | None]:
        """The reference before and after a step, and the posture that attracts the joints.

        Args:
            h: duration of the step [s].
            deviation: distance of the tool from the reference [m].
            threat: the nearest obstacle that the policies react to.

        Returns:
            Both states of the reference, and the posture `(n,)` [rad]; None means that of the reference.
        """

    @property
    def gives_way(self) -> bool:
        """Whether the reference is held up by an obstacle that moves."""
        return False

    @property
    @abstractmethod
    def remaining(self) -> float:
        """Planned time that is left to the end of the plan [s]."""

    @property
    def rest(self) -> ReferenceTrajectory | None:
        """The reference from here to its end, where it advances as planned; None where it does not."""
        return None

    @property
    def is_over(self) -> bool:
        """Whether the reference is at the end of the plan."""
        return self.remaining <= 0.0


class ShapedPursuit(Pursuit):
    """The reference moves along the plan, and waits for a tool that is held up."""

    def __init__(self, plan: MotionPlan, monitor: SpeedSeparationMonitor) -> None:
        super().__init__(plan)
        self._monitor = monitor
        self._time = 0.0
        self._planned = self._state = plan.trajectory.start

    def advance(
        self, h: float, deviation: float, threat: Threat
    ) -> tuple[JointState, JointState, Array | None]:
        """See `Pursuit`."""
        before, rate = self._state, self.rate
        self.rate = self._monitor.update(self._planned, deviation, threat, h)
        self._time = min(self._time + 0.5 * h * (rate + self.rate), self.plan.trajectory.duration)
        planned, self.segment = self.plan.trajectory.at(self._time)
        # Chain rule for t = r times the clock: v scales with the rate r, a with r^2. The change of the rate
        # itself is left out of a; `Tracker.step` takes the acceleration from the difference of velocities.
        self._planned = planned
        self._state = JointState(planned.q, self.rate * planned.v, self.rate**2 * planned.a)
        return before, self._state, None

    @property
    def gives_way(self) -> bool:
        """Whether the reference is held up by an obstacle that moves."""
        return self._monitor.gives_way

    @property
    def remaining(self) -> float:
        """Planned time that is left to the end of the plan [s]."""
        return self.plan.trajectory.duration - self._time

    @property
    def rest(self) -> ReferenceTrajectory | None:
        """See `Pursuit`."""
        return self.plan.trajectory.after(self._time) if self.rate == 1.0 else None


class StaticPursuit(Pursuit):
    """The reference is the end of a segment, and jumps to the next one once the tool has arrived there."""

    NEAR = 0.002
    """Deviation of the tool's point below which it has arrived [m]."""

    def __init__(self, plan: MotionPlan, q_home: Array) -> None:
        super().__init__(plan)
        rows = plan.trajectory
        self._goals = [rows.q[rows.segment == k][-1] for k in np.unique(rows.segment)]
        self._segments = np.unique(rows.segment).tolist()
        self._ends = [float(rows.times[rows.segment == k][-1]) for k in self._segments]
        self._index, self._home, self._is_new, self._is_over = 0, q_home, True, False

    def advance(
        self, h: float, deviation: float, threat: Threat
    ) -> tuple[JointState, JointState, Array | None]:
        """See `Pursuit`."""
        if not self._is_new and deviation < self.NEAR:
            if self._index + 1 < len(self._goals):
                self._index += 1
            else:
                self._is_over = True
        self._is_new = False
        self.segment = self._segments[self._index]
        goal = JointState.at_rest(self._goals[self._index])
        return goal, goal, self._home

    @property
    def remaining(self) -> float:
        """Time that the plan's reference would need from the start of this segment to the end [s]."""
        return 0.0 if self._is_over else self._ends[-1] - self._ends[self._index - 1] * (self._index > 0)


def pursuit_of(plan: MotionPlan, arm: MotionArm, config: MotionSet) -> Pursuit:
    """The pursuit of a plan with the kind of reference that a motion set asks for."""
    if config.reference is Reference.SHAPED:
        return ShapedPursuit(
            plan, SpeedSeparationMonitor(config.speed_separation, arm.chain, arm.limits.acceleration)
        )
    return StaticPursuit(plan, arm.home)
