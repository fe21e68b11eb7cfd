"""Curves of the tool in space, by arc length: straight lines, and corners that are rounded or stops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from pack_core.motion.moves import Line
from pack_core.rotations import Array, Pose, conjugate, exp, log, multiply, to_matrix
from pack_motion.reference.trajectory import MoveRefused

JERK_TIME = 0.1
"""Time in which joint or tool reaches its full acceleration [s]; arms' jerk limits are not published."""
RADIUS = 0.3
"""A turn by 1 rad counts as a path of this length [m], so that lines that only turn have a length too."""
CORNER_ROWS = 65
"""Number of points of a corner at which its arc length is tabulated and its curvature is sampled."""


@dataclass(frozen=True)
class CurvePoints:
    """Tool poses at T points along curves, and their derivatives by the arc length s.

    Attributes:
        p: positions `(T, 3)` [m].
        R: orientations `(T, 3, 3)`.
        dp: first derivative of the position `(T, 3)`.
        ddp: second derivative of the position `(T, 3)` [1/m].
        turn: rotation vector per arc length in world axes `(T, 3)` [rad/m].
        dturn: its derivative `(T, 3)` [rad/m^2].
    """

    p: Array
    R: Array
    dp: Array
    ddp: Array
    turn: Array
    dturn: Array


class Curve(Protocol):
    """A curve of the tool."""

    length: float
    """Arc length [m]."""

    def at(self, s: Array) -> CurvePoints:
        """Tool poses at arc lengths `(T,)` from 0 to `length` [m]."""


class StraightCurve:
    """A straight line from pose to pose that turns evenly about one axis."""

    def __init__(self, X_start: Pose, X_end: Pose) -> None:
        step = X_end.p - X_start.p
        turn = log(multiply(X_end.q, conjugate(X_start.q)))
        self._p, self._q = X_start.p, X_start.q
        self.length = max(float(np.linalg.norm(step)), RADIUS * float(np.linalg.norm(turn)))
        self.direction = step / max(self.length, 1e-12)
        """Derivative of the position by the arc length `(3,)`; below 1 where the turn decides the length."""
        self.turn = turn / max(self.length, 1e-12)
        """Rotation vector per arc length `(3,)` [rad/m]."""

    def at(self, s: Array) -> CurvePoints:
        """Tool poses at arc lengths `(T,)` [m]."""
        R = to_matrix(multiply(exp(s[:, None] * self.turn), np.broadcast_to(self._q, (len(s), 4))))
        dp, turn = (np.broadcast_to(row, (len(s), 3)) for row in (self.direction, self.turn))
        zero = np.zeros((len(s), 3))
        return CurvePoints(self._p + s[:, None] * dp, R, dp, zero, turn, zero)


class CornerCurve:
    """A corner rounded by a quintic Bezier curve that leaves and meets the lines without curvature.

    The first three control points lie on the first line and the last three on the second, so that the second
    derivative is along the line at both ends.

    Args:
        p: where it leaves the first line, the corner, and where it meets the second line `(3, 3)` [m].
        q: orientation of the tool where it leaves the first line `(4,)`.
        turn: rotation vector per arc length of both lines `(3,)` [rad/m].
    """

    def __init__(self, p: Array, q: Array, turn: Array) -> None:
        first, corner, last = p
        self._points = np.array(
            [first, first + 0.4 * (corner - first), first + 0.8 * (corner - first),
             last + 0.8 * (corner - last), last + 0.4 * (corner - last), last]
        )  # fmt: skip
        self._R, self._q, self._turn = to_matrix(q), q, turn
        u = np.linspace(0.0, 1.0, CORNER_ROWS)
        # Arc length at every u by Gauss-Legendre quadrature of |dp/du| between neighbouring u; then u(s) by a
        # cubic through these values with the slopes du/ds = 1 / |dp/du|.
        nodes, weights = np.polynomial.legendre.leggauss(5)
        inner = u[:-1, None] + np.diff(u)[:, None] * 0.5 * (nodes + 1.0)
        speeds = np.linalg.norm(self._bezier(inner.ravel(), 1), axis=1).reshape(inner.shape)
        way = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(u) * (speeds @ weights))])
        self._knots = way, u, 1.0 / np.linalg.norm(self._bezier(u, 1), axis=1)
        self.length = float(way[-1])
        cut_off = float(np.linalg.norm(corner - first) + np.linalg.norm(last - corner))
        # The corner is shorter than what it cuts off the lines, by this share, but the tool turns as far.
        self._ahead = cut_off / self.length - 1.0

    @property
    def sharpest(self) -> float:
        """Largest curvature [1/m]."""
        bends = self.at(np.linspace(0.0, self.length, CORNER_ROWS)).ddp
        return float(np.linalg.norm(bends, axis=1).max())

    def at(self, s: Array) -> CurvePoints:
        """Tool poses at arc lengths `(T,)` [m]."""
        u = np.clip(hermite(s, *self._knots), 0.0, 1.0)
        d, dd = self._bezier(u, 1), self._bezier(u, 2)
        rate = np.linalg.norm(d, axis=1, keepdims=True)
        dp = d / rate
        # Curvature vector: the part of p'' across the tangent, over |p'|^2.
        ddp = (dd - np.sum(dd * dp, axis=1, keepdims=True) * dp) / rate**2
        return CurvePoints(self._bezier(u, 0), *self._turned(s, dp, ddp))

    def _turned(self, s: Array, dp: Array, ddp: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Orientations, the given derivatives, and those of the rotation.

        The angle is the cubic with the lines' rate at both ends that turns by as much as the lines did.
        """
        if not self._turn.any():
            zero = np.zeros((len(s), 3))
            return np.broadcast_to(self._R, (len(s), 3, 3)), dp, ddp, zero, zero
        w, length, ahead = (s / self.length)[:, None], self.length, self._ahead
        angle = length * (w + ahead * w**2 * (3.0 - 2.0 * w)) * self._turn
        R = to_matrix(multiply(exp(angle), np.broadcast_to(self._q, (len(s), 4))))
        turn = (1.0 + 6.0 * ahead * w * (1.0 - w)) * self._turn
        return R, dp, ddp, turn, 6.0 * ahead * (1.0 - 2.0 * w) / length * self._turn

    def _bezier(self, u: Array, order: int) -> Array:
        """Derivative of the given order at parameters `(T,)` by de Casteljau's algorithm: `(T, 3)`."""
        points, degree, factor = self._points, 5, 1.0
        for _ in range(order):
            points, factor, degree = np.diff(points, axis=0), factor * degree, degree - 1
        points, u = np.broadcast_to(points, (len(u), *points.shape)), u[:, None, None]
        for _ in range(degree):
            points = (1.0 - u) * points[:, :-1] + u * points[:, 1:]
        return np.asarray(factor * points[:, 0])


def hermite(x: Array, xs: Array, ys: Array, slopes: Array) -> Array:
    """Piecewise cubic `(T,)` at `x` `(T,)`, with values and slopes given at rising `xs` `(n,)`.

    As `scipy.interpolate.CubicHermiteSpline`, whose import costs every start of an arm's nodes half a second.
    """
    k = np.clip(np.searchsorted(xs, x, side="right") - 1, 0, len(xs) - 2)
    step = xs[k + 1] - xs[k]
    t = (x - xs[k]) / step
    mean = (ys[k + 1] - ys[k]) / step
    first, last = slopes[k] - mean, mean - slopes[k + 1]  # how far the ends' slopes are off the chord's
    return np.asarray(ys[k] + step * t * (mean + (1.0 - t) * ((1.0 - t) * first + t * last)))


def trimmed(X_start: Pose, X_end: Pose, cuts: Sequence[float]) -> StraightCurve:
    """The line between two poses whose orientations are equal, or so near that it is as long as the way.

    A length `cuts` is cut off at each end [m].
    """
    step = X_end.p - X_start.p
    direction = step / np.linalg.norm(step)
    ends = X_start.p + cuts[0] * direction, X_end.p - cuts[1] * direction
    turn = _turn_of(X_start, X_end)
    q_start, q_end = multiply(exp(cuts[0] * turn), X_start.q), multiply(exp(-cuts[1] * turn), X_end.q)
    return StraightCurve(Pose(ends[0], q_start), Pose(ends[1], q_end))


def _turn_of(X_start: Pose, X_end: Pose) -> Array:
    """Rotation vector per length of a line `(3,)` [rad/m]; exactly zero if it is one by rounding only."""
    line = StraightCurve(X_start, X_end)
    return line.turn if np.linalg.norm(line.turn) * line.length > IN_LINE else np.zeros(3)


IN_LINE = 1e-4
"""Directions that differ by less count as equal [rad]."""
SHORTEST = 1e-6
"""Shorter lines are left out [m]."""
REVERSAL = 0.2
"""A line back that differs by less from the opposite direction is not rounded into [rad]: the tool would
creep round so narrow a corner, and a stop is faster."""


@dataclass(frozen=True)
class SegmentLimits:
    """How fast the tool may move along one segment of its curve.

    Attributes:
        length: arc length [m].
        speed: largest speed [m/s].
        acceleration: largest acceleration [m/s^2]; it is reached within `JERK_TIME`.
        exit_speed: largest speed at its end [m/s].
    """

    length: float
    speed: float
    acceleration: float
    exit_speed: float

    @property
    def jerk(self) -> float:
        """Largest jerk [m/s^3]."""
        return self.acceleration / JERK_TIME


@dataclass(frozen=True)
class CurveSegment:
    """A line or a corner, its limits, and the index of the segment of the path that it belongs to."""

    curve: Curve
    limits: SegmentLimits
    index: int


def curve_segments(X_start: Pose, lines: Sequence[Line], first: int) -> list[CurveSegment]:
    """The curves of consecutive lines; `first` is the index of the first line in its path."""
    poses = [X_start, *(line.X_WT for line in lines)]
    cuts = [0.0, *(_cut(poses[i : i + 3], line) for i, line in enumerate(lines[:-1])), 0.0]
    found: list[CurveSegment] = []
    for i, line in enumerate(lines):
        curve = _straight(poses[i], poses[i + 1], cuts[i], cuts[i + 1])
        exit_speed = line.exit_speed
        if i + 1 < len(lines) and not cuts[i + 1] and not _is_in_line(poses[i : i + 3]):
            exit_speed = 0.0
        if curve.length > SHORTEST:
            limits = SegmentLimits(curve.length, line.speed, line.acceleration, exit_speed)
            found.append(CurveSegment(curve, limits, first + i))
        if cuts[i + 1]:
            found.append(_corner(poses[i : i + 3], cuts[i + 1], line, lines[i + 1], first + i))
    return found


def _straight(X_start: Pose, X_end: Pose, cut_start: float, cut_end: float) -> StraightCurve:
    if not cut_start and not cut_end:
        return StraightCurve(X_start, X_end)
    return trimmed(X_start, X_end, (cut_start, cut_end))


def _cut(poses: Sequence[Pose], line: Line) -> float:
    """Length that the corner cuts off both lines [m]: at most half of the shorter line, 0 at a reversal."""
    if not line.blend or not line.exit_speed or _is_in_line(poses):
        return 0.0
    turns = [_turn_of(poses[0], poses[1]), _turn_of(poses[1], poses[2])]
    before, after = poses[1].p - poses[0].p, poses[2].p - poses[1].p
    lengths = float(np.linalg.norm(before)), float(np.linalg.norm(after))
    cut = min(line.blend, 0.5 * min(lengths))
    # Where the turn takes longer than the way, its length is not that of the way.
    is_quick = RADIUS * max(float(np.linalg.norm(turn)) for turn in turns) > 1.0 - IN_LINE
    if is_quick or cut * np.linalg.norm(turns[1] - turns[0]) > IN_LINE:
        raise MoveRefused(
            f"'{line.label}' is blended though the tool turns along it or after it, not slowly and evenly "
            "along both; set blend to 0"
        )
    is_reversal = before @ after < -np.cos(REVERSAL) * lengths[0] * lengths[1]
    return 0.0 if is_reversal else cut


def _corner(poses: Sequence[Pose], cut: float, line: Line, after: Line, segment: int) -> CurveSegment:
    before, corner, last = (pose.p for pose in poses)
    start = corner + cut * (before - corner) / np.linalg.norm(before - corner)
    end = corner + cut * (last - corner) / np.linalg.norm(last - corner)
    turn = _turn_of(poses[0], poses[1])
    q = multiply(exp(-cut * turn), poses[1].q)
    curve = CornerCurve(np.array([start, corner, end]), q, turn)
    acceleration = min(line.acceleration, after.acceleration)
    # Centripetal acceleration v^2 kappa within the limit: v <= sqrt(a / kappa).
    speed = min(line.exit_speed, after.speed, float(np.sqrt(acceleration / curve.sharpest)))
    return CurveSegment(curve, SegmentLimits(curve.length, speed, acceleration, speed), segment)


def _is_in_line(poses: Sequence[Pose]) -> bool:
    """Whether two lines have the same direction and the same turn per length."""
    first, second = (StraightCurve(poses[i], poses[i + 1]) for i in (0, 1))
    if min(first.length, second.length) < SHORTEST:
        return False
    bend, twist = first.direction - second.direction, first.turn - second.turn
    return bool(np.linalg.norm(bend) < IN_LINE and np.linalg.norm(twist) < IN_LINE)
