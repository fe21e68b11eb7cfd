"""A joint trajectory controller, written from what ros2_control says of its own, for tests of other drivers.

Sources: the controller's manual at control.ros.org (trajectory representation and replacement, preemption,
actions, speed scaling, parameters) and the texts of control_msgs. It knows no ROS and nothing of PackCell but
what a desired state of joints is. Where the manual leaves something open, it does what is harder for whoever
sends the trajectories: it goes from the measured state to a first point that is still to come, it holds where
the arm is measured at once, and it knows neither limits nor a watchdog.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto

import numpy as np

from pack_core.joints import Desired
from pack_core.rotations import Array

RAMP = 0.25
"""Time in which the scaling goes from 0 to 1 [s]."""


class Outcome(Enum):
    """How an action's goal ended."""

    SUCCEEDED = auto()
    ABORTED = auto()
    CANCELED = auto()


class Rejected(Exception):
    """A trajectory that is not taken."""


@dataclass(frozen=True)
class Waypoint:
    """Where the joints shall be at a time from the start [s]; without velocities a spline is linear."""

    offset: float
    q: Array
    v: Array | None = None
    a: Array | None = None
    effort: Array | None = None
    """Fed forward to effort interfaces, linearly between points."""


@dataclass(frozen=True)
class Tolerances:
    """Allowed errors of the joints `(n,)` [rad]; 0 where none is enforced."""

    path: Array
    goal: Array
    goal_time: float = 0.0
    """After the end of a trajectory [s of its own time]; 0: for ever."""


@dataclass
class Goal:
    """An action's goal and how it ended."""

    tolerances: Tolerances
    outcome: Outcome | None = None
    error_code: int = 0
    error: str = ""

    def end(self, outcome: Outcome, error_code: int = 0, error: str = "") -> None:
        if self.outcome is None:
            self.outcome, self.error_code, self.error = outcome, error_code, error


INVALID_GOAL, PATH_TOLERANCE_VIOLATED, GOAL_TOLERANCE_VIOLATED = -1, -4, -5
"""Error codes of FollowJointTrajectory."""


@dataclass
class State:
    """What `controller_state` tells of a cycle."""

    time: float
    reference: Desired
    q: Array
    v: Array
    scaling: float


@dataclass
class JointTrajectoryController:
    """Samples the newest trajectory in each cycle.

    Attributes:
        n: number of joints.
        defaults: tolerances of trajectories that state none.
        speed: what the operator's slider is at, 0 to 1.
        scaling: trajectory seconds a second; it follows the slider within `RAMP` from 0 to 1.
        stop_time: time in which a stopped arm comes to rest [s].
        drives_effort: whether it commands efforts, and stops by a hold where the arm is measured; otherwise
            it commands positions.
        interpolates_from_desired: whether a trajectory is joined from what was desired last, or from where
            the arm is measured.
        may_end_moving: whether a trajectory may end with a velocity; its last point then stands as it is.
        command_timeout: time after the end of a trajectory at which the arm is held where it is [s]; 0: never
    """

    n: int
    defaults: Tolerances
    speed: float = 1.0
    scaling: float = 1.0
    stop_time: float = 0.5
    drives_effort: bool = False
    interpolates_from_desired: bool = False
    may_end_moving: bool = False
    command_timeout: float = 0.0
    goal: Goal | None = None
    is_stopped: bool = False
    state: State | None = None
    accepted: int = 0
    _points: tuple[Waypoint, ...] = ()
    _start: float = 0.0
    _clock: float = 0.0
    _before: Waypoint | None = None
    _next: int = 0
    _spline: Spline | None = None
    _hold: Desired | None = None
    _brake: tuple[float, Desired] | None = None
    _ended: list[Goal] = field(default_factory=list)

    # Commands

    def follow(self, points: tuple[Waypoint, ...], stamp: float, tolerances: Tolerances | None) -> Goal:
        """An action's goal, from now on; the one before is aborted.

        Args:
            points: the trajectory.
            stamp: when it begins [s]; 0: now.
            tolerances: None for the defaults.

        Raises:
            Rejected: the trajectory is not taken, and the one before goes on.
        """
        self.check(points, stamp)
        self._end_goal(Outcome.ABORTED, INVALID_GOAL, "replaced by a new goal")
        self._take(points, stamp)
        self.goal = Goal(tolerances or self.defaults)
        self.accepted += 1
        return self.goal

    def take(self, points: tuple[Waypoint, ...], stamp: float) -> None:
        """A trajectory of the topic: as a goal, but nobody is told how it went; raises Rejected."""
        self.check(points, stamp)
        self._take(points, stamp)

    def cancel(self) -> None:
        """Give the goal up and hold the arm where it is."""
        self._end_goal(Outcome.CANCELED)
        self._hold_here()

    def stop(self) -> None:
        """An emergency stop: brake, give the goal up, and take nothing until `release`."""
        self._end_goal(Outcome.ABORTED, INVALID_GOAL, "the robot was stopped")
        if self.drives_effort:
            self._hold = None
        elif self.state is not None and not self.is_stopped:
            self._brake = self.state.time, self.state.reference
        self.is_stopped, self._points = True, ()

    def release(self) -> None:
        """Take trajectories again; none is taken up by itself."""
        self.is_stopped = False

    def ended(self) -> list[Goal]:
        """The goals that have ended since the last call."""
        ended, self._ended = self._ended, []
        return ended

    # A cycle

    def begin(self, time: float, q: Array, v: Array) -> None:
        """Hold an arm that is at rest at `q`, as after the start, or after it was put elsewhere."""
        self._points, self._hold, self._brake, self.state = (), None, None, None
        self.update(time, q, v)

    def update(self, time: float, q: Array, v: Array) -> Desired:
        """What is commanded of the joints in the cycle at `time` [s], from their measured state."""
        if self.state is not None:
            h = time - self.state.time
            self._clock += h * self.scaling
            self.scaling += float(np.clip(self.speed - self.scaling, -h / RAMP, h / RAMP))
        reference = self._sampled(time, q)
        self.state = State(time, reference, q.copy(), v.copy(), self.scaling)
        if self.goal is not None and self._points:
            self._judge(self.goal, reference[0] - q)
        return self.state.reference

    def _sampled(self, time: float, q: Array) -> Desired:
        if self._brake is not None:
            return self._braked(time)
        if not self._points:
            if self._hold is None:
                self._hold = q.copy(), np.zeros(self.n), np.zeros(self.n)
            return self._hold
        tau = self._clock - self._start
        if self._before is None:  # the first cycle of this trajectory
            self._before = self._joined(tau, q)
        points, k = self._points, self._next
        while k < len(points) and points[k].offset <= tau:
            k += 1
        if k == len(points):
            return self._after_end(points[-1], tau, q)
        start = points[k - 1] if k else self._before
        if k != self._next or self._spline is None:
            self._next, self._spline = k, Spline(start, points[k])
        position, velocity, acceleration = self._spline.at(tau)
        effort = effort_between(start, points[k], tau)
        forward = self.scaling**2 * acceleration if effort is None else effort
        return position, self.scaling * velocity, forward

    def _joined(self, tau: float, q: Array) -> Waypoint:
        """Where the way to the first point of a new trajectory begins, at its time `tau` [s]."""
        rest = np.zeros(self.n)
        if not self.interpolates_from_desired or self.state is None:
            return Waypoint(tau, q.copy(), rest, rest)
        position, velocity, forward = self.state.reference
        if self._points[0].effort is None:
            return Waypoint(tau, position, velocity, forward)
        return Waypoint(tau, position, velocity, effort=forward)

    def _after_end(self, last: Waypoint, tau: float, q: Array) -> Desired:
        """The last point, until the arm is held; with a velocity and an effort, where it may have them."""
        rest = np.zeros(self.n)
        if 0.0 < self.command_timeout < tau - last.offset:
            self._points, self._hold = (), (q.copy(), rest, rest)
            return self._hold
        if not self.may_end_moving or last.v is None:
            return last.q, rest, rest
        return last.q, last.v, rest if last.effort is None else last.effort

    def _braked(self, time: float) -> Desired:
        """Every joint slows down evenly to rest within `stop_time`."""
        assert self._brake is not None
        begun, (q, v, _) = self._brake
        t = min(time - begun, self.stop_time)
        a = -v / self.stop_time
        position = q + v * t + 0.5 * a * t * t
        if t < self.stop_time:
            return position, v + a * t, a
        rest = np.zeros(self.n)
        self._hold, self._brake = (position, rest, rest), None
        return self._hold

    def _judge(self, goal: Goal, error: Array) -> None:
        tau, tolerances = self._clock - self._start, goal.tolerances
        if tau < self._points[-1].offset:
            if beyond(error, tolerances.path):
                self._fail(PATH_TOLERANCE_VIOLATED, f"off the path by up to {np.abs(error).max():.4f} rad")
        elif not beyond(error, tolerances.goal):
            self._end_goal(Outcome.SUCCEEDED)
        elif 0.0 < tolerances.goal_time < tau - self._points[-1].offset:
            self._fail(GOAL_TOLERANCE_VIOLATED, f"off the goal by up to {np.abs(error).max():.4f} rad")

    def give_up(self, why: str) -> None:
        """End the goal as if a joint had left its path, and hold the arm."""
        self._fail(PATH_TOLERANCE_VIOLATED, why)

    def _fail(self, code: int, why: str) -> None:
        self._end_goal(Outcome.ABORTED, code, why)
        self._hold_here()

    def _hold_here(self) -> None:
        self._points, self._hold = (), None

    def _end_goal(self, outcome: Outcome, code: int = 0, why: str = "") -> None:
        if self.goal is not None:
            self.goal.end(outcome, code, why)
            self._ended.append(self.goal)
            self.goal = None

    def _take(self, points: tuple[Waypoint, ...], stamp: float) -> None:
        assert self.state is not None
        self._clock = self.state.time
        self._points, self._start, self._before = points, stamp or self._clock, None
        self._next, self._spline = 0, None

    def check(self, points: tuple[Waypoint, ...], stamp: float) -> None:
        """Raises Rejected where a trajectory is not taken."""
        if self.state is None or self.is_stopped:
            raise Rejected("the robot is stopped")
        if not points:
            raise Rejected("a trajectory without points")
        offsets = np.array([point.offset for point in points])
        if np.any(np.diff(offsets) <= 0.0) or offsets[0] < 0.0:
            raise Rejected("times from the start that do not rise")
        if any(
            len(column) != self.n
            for p in points
            for column in (p.q, p.v, p.a, p.effort)
            if column is not None
        ):
            raise Rejected(f"points of another size than the {self.n} joints")
        if stamp and stamp + offsets[-1] < self.state.time:
            raise Rejected("a trajectory that ends in the past")
        last = points[-1].v
        if last is not None and np.abs(last).max() > 1e-9 and not self.may_end_moving:
            raise Rejected("a trajectory whose last velocity is not zero")


def beyond(error: Array, tolerance: Array) -> bool:
    """Whether a joint is farther off than allowed, where that is enforced."""
    return bool(np.any((tolerance > 0.0) & (np.abs(error) > tolerance)))


def effort_between(start: Waypoint, end: Waypoint, tau: float) -> Array | None:
    """What is fed forward between two points at a trajectory's time [s]; None where either states none."""
    if start.effort is None or end.effort is None:
        return None
    share = (tau - start.offset) / (end.offset - start.offset)
    return np.asarray((1.0 - share) * start.effort + share * end.effort)


class Spline:
    """Position, velocity and acceleration between two points, by what both of them hold.

    Only positions: linear. With velocities: cubic. With accelerations, too: quintic. The coefficients, of the
    powers of the share of the time between the points, solve the conditions at both ends.
    """

    def __init__(self, start: Waypoint, end: Waypoint) -> None:
        self._start, self._duration = start.offset, end.offset - start.offset
        conditions = [(start.q, end.q)]
        if start.v is not None and end.v is not None:
            conditions.append((start.v, end.v))
            if start.a is not None and end.a is not None:
                conditions.append((start.a, end.a))
        self._degree = 2 * len(conditions)
        rows = np.concatenate([self._powers(s)[: len(conditions)] for s in (0.0, 1.0)])
        scales = self._duration ** np.arange(len(conditions))
        ends = np.array(
            [scale * pair[k] for k in (0, 1) for scale, pair in zip(scales, conditions, strict=True)]
        )
        self._coefficients = np.linalg.solve(rows, ends)

    def at(self, tau: float) -> Desired:
        """What is asked for at a trajectory's time [s]."""
        derivatives = self._powers((tau - self._start) / self._duration) @ self._coefficients
        q, v, a = derivatives / self._duration ** np.arange(3)[:, None]
        return q, v, a

    def _powers(self, s: float) -> Array:
        """The powers of s up to the degree, and their first two derivatives, `(3, degree + 1)`."""
        powers = np.polynomial.polynomial.polyvander(s, self._degree - 1).ravel()
        k = np.arange(self._degree)
        first, second = np.zeros_like(powers), np.zeros_like(powers)
        first[1:], second[2:] = k[1:] * powers[:-1], k[2:] * k[1:-1] * powers[:-2]
        return np.stack([powers, first, second])
