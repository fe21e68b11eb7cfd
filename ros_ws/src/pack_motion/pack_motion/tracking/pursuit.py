"""How the reference of the policies advances through a plan."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.arm.bodies import BodyBoxes
from pack_motion.reference.path_planner import MotionPlan
from pack_motion.reference.trajectory import REST_SPEED, JointState, ReferenceTrajectory
from pack_motion.safety.separation_monitor import Margin, Seen, SeparationMonitor
from pack_motion.tracking.config import MotionSet, Reference, Waiting


class Pursuit(ABC):
    """One plan being followed."""

    def __init__(self, plan: MotionPlan) -> None:
        self.plan = plan
        self.segment = int(plan.trajectory.segment[0])
        self.rate = 1.0
        """Rate at which the reference advances; 1 is as planned."""

    @abstractmethod
    def advance(
        self, h: float, deviation: float, q: Array, seen: Seen
    ) -> tuple[JointState, JointState, Array | None]:
        """The reference before and after a step, and the posture that attracts the joints.

        Args:
            h: duration of the step [s].
            deviation: distance of the tool from the reference [m].
            q: commanded joint positions `(n,)` [rad].
            seen: who is seen around the arm.

        Returns:
            Both states of the reference, and the posture `(n,)` [rad]; None means that of the reference.
        """

    @property
    def margin(self) -> Margin:
        """How much farther than it must be the arm is from those who are seen."""
        return Margin()

    @property
    def gives_way(self) -> bool:
        """Whether the reference is held up to keep the distance from somebody, or has just been."""
        return False

    @property
    def is_moving(self) -> bool:
        """Whether the reference moves."""
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
    """The reference moves along the plan, waits for a tool that is held up, and keeps clear of people.

    A `stop` is carried out at full rate: nothing ends it sooner. Its margin is measured all the same.
    """

    def __init__(
        self, plan: MotionPlan, monitor: SeparationMonitor, waiting: Waiting, *, is_stop: bool = False
    ) -> None:
        super().__init__(plan)
        self._monitor, self._waiting, self._is_stop = monitor, waiting, is_stop
        self._time = 0.0
        self._planned = self._state = plan.trajectory.start
        self._calm = np.inf

    def advance(
        self, h: float, deviation: float, q: Array, seen: Seen
    ) -> tuple[JointState, JointState, Array | None]:
        """See `Pursuit`."""
        before, rate = self._state, self.rate
        if self._is_stop:
            self._monitor.rate(h, self.plan.trajectory, self._time, (rate, rate, rate), q, seen)
        else:
            self.rate = self._next_rate(h, deviation, q, seen)
        self._time = min(self._time + 0.5 * h * (rate + self.rate), self.plan.trajectory.duration)
        planned, self.segment = self.plan.trajectory.at(self._time)
        # Chain rule for t = r times the clock: v scales with the rate r, a with r^2. The change of the rate
        # itself is left out of a; `Tracker.step` takes the acceleration from the difference of velocities.
        self._planned = planned
        self._state = JointState(planned.q, self.rate * planned.v, self.rate**2 * planned.a)
        return before, self._state, None

    def _next_rate(self, h: float, deviation: float, q: Array, seen: Seen) -> float:
        c = self._waiting
        # Falls linearly from 1 where the tool is `near` its reference to 0 where it is `far` from it.
        wished = min(max((c.far - deviation) / (c.far - c.near), 0.0), 1.0)
        slowest, fastest = self._monitor.bounds(self._planned.v, self._planned.a, self.rate)
        lowest, highest = max(self.rate + h * slowest, 0.0), min(self.rate + h * fastest, 1.0)
        highest = min(max(wished, lowest), highest)
        rates = lowest, self.rate, highest
        rate = self._monitor.rate(h, self.plan.trajectory, self._time, rates, q, seen)
        is_held = rate < highest or self._monitor.margin.value < 0.0
        self._calm = 0.0 if is_held else self._calm + h
        return rate

    @property
    def margin(self) -> Margin:
        """How much farther than it must be the arm is from those who are seen."""
        return self._monitor.margin

    @property
    def gives_way(self) -> bool:
        """Whether the reference is held up to keep the distance from somebody, or has just been."""
        return self._calm < self._waiting.calm_time

    @property
    def is_moving(self) -> bool:
        """Whether the reference moves."""
        return bool(np.abs(self._state.v).max() > REST_SPEED)

    @property
    def remaining(self) -> float:
        """Planned time that is left to the end of the plan [s]."""
        return self.plan.trajectory.duration - self._time

    @property
    def rest(self) -> ReferenceTrajectory | None:
        """See `Pursuit`."""
        return self.plan.trajectory.after(self._time) if self.rate == 1.0 else None


class StaticPursuit(Pursuit):
    """The reference is the end of a segment, and jumps to the next one once the tool has arrived there.

    Its rate is 0 but in the step in which it jumps: a tool that obstacles keep from its target is stuck.
    """

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
        self, h: float, deviation: float, q: Array, seen: Seen
    ) -> tuple[JointState, JointState, Array | None]:
        """See `Pursuit`."""
        has_arrived = not self._is_new and deviation < self.NEAR
        if has_arrived:
            if self._index + 1 < len(self._goals):
                self._index += 1
            else:
                self._is_over = True
        self.rate = 1.0 if has_arrived or self._is_new else 0.0
        self._is_new = False
        self.segment = self._segments[self._index]
        goal = JointState.at_rest(self._goals[self._index])
        return goal, goal, self._home

    @property
    def remaining(self) -> float:
        """Time that the plan's reference would need from the start of this segment to the end [s]."""
        return 0.0 if self._is_over else self._ends[-1] - self._ends[self._index - 1] * (self._index > 0)


def pursuit_of(
    plan: MotionPlan, arm: MotionArm, bodies: BodyBoxes, config: MotionSet, *, is_stop: bool = False
) -> Pursuit:
    """The pursuit of a plan with the kind of reference that a motion set asks for.

    Args:
        plan: the plan.
        arm: the arm that follows it.
        bodies: boxes around its links and what it carries.
        config: the motion set.
        is_stop: whether the plan is a stop.
    """
    if config.reference is Reference.SHAPED:
        monitor = SeparationMonitor(config.separation, arm, bodies, config.waiting.time)
        return ShapedPursuit(plan, monitor, config.waiting, is_stop=is_stop)
    return StaticPursuit(plan, arm.home)
