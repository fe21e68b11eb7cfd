"""Turns consecutive lines of the tool into a joint reference.

The speed along the lines comes first, jerk-limited and without a stop between them; then inverse kinematics
row by row; then, where a joint would exceed its limits, less acceleration or a slower run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt
import ruckig

from pack_core.kinematics.inverse import Branch, InverseKinematics
from pack_core.rotations import Array
from pack_motion.reference.curve import JERK_TIME, CurvePoints, CurveSegment, SegmentLimits
from pack_motion.reference.joint_move import MoveLimits, fastest
from pack_motion.reference.trajectory import MoveRefused, ReferenceTrajectory, grid

OVERSHOOT = 1e-6
"""A profile may overrun the ends of its segment by this, for rounding [m]."""
BISECTIONS = 40
"""Number of halvings of the interval in which a speed is searched."""


def change_length(limits: SegmentLimits, v_0: float, v_1: float) -> float:
    """Shortest length [m] for a change of speed from `v_0` to `v_1` [m/s] within a segment's limits."""
    change, a = abs(v_1 - v_0), limits.acceleration
    # The acceleration rises and falls within JERK_TIME each. If the change is large enough it stays at its
    # largest value between, else it turns at a lower peak. By symmetry the mean speed is (v_0 + v_1) / 2.
    has_plateau = change >= a * JERK_TIME
    time = change / a + JERK_TIME if has_plateau else 2.0 * np.sqrt(change / limits.jerk)
    return float(0.5 * (v_0 + v_1) * time)


def border_speeds(run: Sequence[SegmentLimits], entry_speed: float) -> list[float]:
    """The highest feasible speeds at all borders between segments, first and last included [m/s].

    Each starts from its limit. A backward pass lowers speeds from which the segment after cannot brake in
    time, a forward pass those that cannot be reached from the border before.
    """
    speeds = [min(entry_speed, run[0].speed)]
    following = [*run[1:], None]
    for limits, after in zip(run, following, strict=True):
        limit = after.speed if after else limits.speed
        speeds.append(min(limits.exit_speed, limits.speed, limit))
    for i in reversed(range(len(run))):
        speeds[i] = _reachable(run[i], speeds[i + 1], speeds[i])
    for i, limits in enumerate(run):
        speeds[i + 1] = _reachable(limits, speeds[i], speeds[i + 1])
    return speeds


def speed_profile(limits: SegmentLimits, v_0: float, v_1: float) -> ruckig.Trajectory:
    """Arc length over time along one segment, entered at `v_0` and left at `v_1` [m/s].

    Raises:
        MoveRefused: the speeds do not fit the length, so that the profile would overrun the segment's ends.
    """
    request = ruckig.InputParameter(1)
    request.target_position, request.max_velocity = [limits.length], [max(limits.speed, v_0, v_1)]
    request.current_velocity, request.target_velocity = [v_0], [v_1]
    request.max_acceleration, request.max_jerk = [limits.acceleration], [limits.jerk]
    found = fastest(request)
    if found is None or not _is_inside(found, limits.length):
        raise MoveRefused(
            f"a line of {1000 * limits.length:.0f} mm cannot be entered at {v_0:.3f} m/s "
            f"and left at {v_1:.3f} m/s"
        )
    return found


def _is_inside(found: ruckig.Trajectory, length: float) -> bool:
    extent = found.position_extrema[0]
    return bool(extent.min >= -OVERSHOOT and extent.max <= length + OVERSHOOT)


def _reachable(limits: SegmentLimits, fixed: float, wished: float) -> float:
    """The highest speed up to `wished` at one end, with `fixed` at the other, that the length allows."""
    if wished <= fixed or change_length(limits, fixed, wished) <= limits.length:
        return wished
    near, far = fixed, wished
    for _ in range(BISECTIONS):
        middle = 0.5 * (near + far)
        if change_length(limits, fixed, middle) <= limits.length:
            near = middle
        else:
            far = middle
    return near


LARGEST_STEP = 0.5
"""Largest step of a joint between rows [rad]; a larger one is a change of branch or a singular wrist."""

SOFTENINGS = 3
"""How often accelerations are lowered, segment by segment, before the run is slowed as a whole."""

FURTHER = 1.02
"""Accelerations are lowered by so much more than the excess: what comes from speed does not shrink."""

LARGEST_SLOWING = 20.0
"""Largest factor by which lines may be slowed to keep the joint limits; beyond it the move is refused."""


class Follower(Protocol):
    """Inverse kinematics along a curve, from one row to the next."""

    def follow_rows(self, R_WT: Array, p_WT: Array, q_start: Array) -> Array:
        """Joint positions `(k, n)` that bring the tool along `(T, 3, 3)` and `(T, 3)`.

        The first is next to `q_start`; k is less than T where the arm cannot follow further.
        """

    def joint_rates(self, times: Array, q: Array, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        """Joint velocities and accelerations `(T, n)` of rows.

        Args:
            times: of the rows `(T,)` [s].
            q: joint positions `(T, n)`, as `follow` found them.
            rates: of the tool `(T, 6)`, world axes: linear, then angular.
            accelerations: of the tool `(T, 6)`.
        """


@dataclass(frozen=True)
class BranchFollower:
    """Follows in one branch of a closed-form inverse."""

    inverse: InverseKinematics
    branch: Branch

    def follow_rows(self, R_WT: Array, p_WT: Array, q_start: Array) -> Array:
        """See `Follower`."""
        return self.inverse.follow_rows(R_WT, p_WT, q_start, self.branch)

    def joint_rates(self, times: Array, q: Array, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        """See `Follower`."""
        return self.inverse.chain.joint_rates(q, rates, accelerations)


class LineRefused(MoveRefused):
    """Lines cannot be followed to their end.

    Attributes:
        length: arc length from their start up to which they can be [m].
    """

    def __init__(self, reason: str, length: float) -> None:
        super().__init__(reason)
        self.length = length


def line_run(
    arm: Follower, run: Sequence[CurveSegment], entry_speed: float, q_start: Array, limits: MoveLimits
) -> ReferenceTrajectory:
    """The joint reference along segments of the curve, slowed as a whole until every joint keeps its limits.

    Raises:
        LineRefused: the lines leave the arm's reach, a joint's range or the branch of the inverse
            kinematics, or pass too near to a singular posture.
    """
    wished = np.array([segment.limits.acceleration for segment in run])
    for _ in range(SOFTENINGS + 1):
        speeds = border_speeds([segment.limits for segment in run], entry_speed)
        times, rates, ways, points, owners = _timed(run, speeds)
        q = _joint_positions(arm, points, ways, q_start)
        try:
            v, a = arm.joint_rates(times, q, *_tool_rates(points, rates))
        except np.linalg.LinAlgError as error:
            raise LineRefused("the line passes a singular posture", 0.0) from error
        excess = np.abs(a / limits.acceleration).max(axis=1)
        if excess.max() <= 1.0:
            break
        # What was softened counts too; unbounded, it makes rows without end of a start in a singular posture.
        softenings = wished / np.array([segment.limits.acceleration for segment in run])
        _check_slowings(np.sqrt(excess * softenings[owners]), ways)
        run = _softened(run, owners, excess)
    segments = np.array([segment.index for segment in run])[owners]
    slowings = _slowings(v, a, limits)
    _check_slowings(slowings, ways)
    slow = float(slowings.max())
    return ReferenceTrajectory(slow * times, q, v / slow, a / slow**2, segments)


def _check_slowings(slowings: Array, ways: Array) -> None:
    """Refuse lines of which a row `(T,)` would take too many times longer; `ways` are its arc lengths [m]."""
    slow = float(slowings.max())
    if not slow < LARGEST_SLOWING:  # written so that nan is refused too
        raise LineRefused(
            f"the line passes so near to a singular posture that it would take {slow:.0f} times longer",
            float(ways[np.argmin(slowings < LARGEST_SLOWING)]),
        )


def _softened(
    run: Sequence[CurveSegment], owners: npt.NDArray[np.int64], excess: Array
) -> list[CurveSegment]:
    """The same segments, with lower accelerations where a joint's acceleration is exceeded by a factor."""
    softened = []
    for i, segment in enumerate(run):
        factor = float(excess[owners == i].max(initial=0.0))
        factor = FURTHER * factor if factor > 1.0 else 1.0
        limits = replace(segment.limits, acceleration=segment.limits.acceleration / factor)
        softened.append(replace(segment, limits=limits))
    return softened


def _timed(
    run: Sequence[CurveSegment], speeds: Sequence[float]
) -> tuple[Array, Array, Array, CurvePoints, npt.NDArray[np.int64]]:
    """Of all rows: times, speed and acceleration on the curve `(T, 2)`, arc lengths, points, segments."""
    times, rates, ways, points, owners, elapsed, way = [], [], [], [], [], 0.0, 0.0
    for i, segment in enumerate(run):
        profile = speed_profile(segment.limits, speeds[i], speeds[i + 1])
        rows = grid(profile.duration)[bool(i) :]  # from the second segment on, row 0 is the last one's end
        states = np.array([profile.at_time(float(time)) for time in rows])[:, :, 0]
        times.append(elapsed + rows)
        rates.append(states[:, 1:])
        points.append(segment.curve.at(np.clip(states[:, 0], 0.0, segment.limits.length)))
        ways.append(way + states[:, 0])
        owners.append(np.full(len(rows), i))
        elapsed, way = elapsed + profile.duration, way + segment.limits.length
    joined = np.concatenate(times), np.concatenate(rates), np.concatenate(ways)
    return *joined, _joined(points), np.concatenate(owners)


def _joined(points: Sequence[CurvePoints]) -> CurvePoints:
    names = [field.name for field in fields(CurvePoints)]
    return CurvePoints(*(np.concatenate([getattr(part, name) for part in points]) for name in names))


def _joint_positions(arm: Follower, points: CurvePoints, ways: Array, q_start: Array) -> Array:
    q = arm.follow_rows(points.R, points.p, q_start)
    steps = np.abs(np.diff(q, axis=0, prepend=q_start[None])).max(axis=1, initial=0.0)
    if steps.max(initial=0.0) > LARGEST_STEP:
        i = int(np.argmax(steps > LARGEST_STEP))
        raise _refused("passes a singular posture", points.p[i], float(ways[i]))
    if (i := len(q)) < len(points.p):
        raise _refused("is out of the arm's reach or joint range", points.p[i], float(ways[i]))
    return q


def _refused(why: str, p: Array, length: float) -> LineRefused:
    return LineRefused(f"the line {why} at {p.round(3).tolist()} m", length)


def _tool_rates(points: CurvePoints, rates: Array) -> tuple[Array, Array]:
    """Velocities and accelerations of the tool `(T, 6)`."""
    ds, dds = rates[:, :1], rates[:, 1:]
    slope = np.hstack([points.dp, points.turn])
    bend = np.hstack([points.ddp, points.dturn])
    # Chain rule for the pose x(s(t)): dx/dt = x' ds/dt, and d2x/dt2 = x' d2s/dt2 + x'' (ds/dt)^2.
    return slope * ds, slope * dds + bend * ds**2


def _slowings(v: Array, a: Array, limits: MoveLimits) -> Array:
    """Factors k >= 1 `(T,)` by which rows must take longer: speeds fall with k, accelerations with k^2."""
    speed = (np.abs(v) / limits.velocity).max(axis=1)
    acceleration = (np.abs(a) / limits.acceleration).max(axis=1)
    return np.asarray(np.maximum(1.0, np.maximum(speed, np.sqrt(acceleration))))
