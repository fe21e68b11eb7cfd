"""Lines of the tool, one after the other, as a joint reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from pack_core.kinematics.inverse import Branch
from pack_core.motion.moves import Line
from pack_core.rotations import Array, Pose, angle_between
from pack_motion.arm.arm import Arm
from pack_motion.reference.curve import CornerCurve, Curve, CurvePoints, StraightCurve, trimmed
from pack_motion.reference.joint_move import MoveLimits
from pack_motion.reference.refusal import MoveRefused
from pack_motion.reference.speed_profile import Portion, border_speeds, portion_profile
from pack_motion.reference.trajectory import Trajectory, grid

IN_LINE = 1e-4
"""Directions that differ by less are one [rad]."""
SHORTEST = 1e-6
"""A shorter line is none [m]."""
LARGEST_STEP = 0.5
"""Of a joint between rows [rad]; a larger one is a jump to another branch, or a singular wrist."""

LARGEST_SLOWING = 20.0
"""Of a run, for the sake of the joint limits."""


@dataclass(frozen=True)
class Stretch:
    """A curve, how fast it is travelled, and which segment of the path it belongs to."""

    curve: Curve
    portion: Portion
    segment: int


def stretches(X_start: Pose, lines: Sequence[Line], first: int) -> list[Stretch]:
    """The curves of consecutive lines; `first` is the index of the first line in its path."""
    poses = [X_start, *(line.X_WT for line in lines)]
    cuts = [0.0, *(_cut(poses[i : i + 3], line) for i, line in enumerate(lines[:-1])), 0.0]
    found: list[Stretch] = []
    for i, line in enumerate(lines):
        curve = _straight(poses[i], poses[i + 1], cuts[i], cuts[i + 1])
        exit_speed = line.exit_speed
        if i + 1 < len(lines) and not cuts[i + 1] and not _is_in_line(poses[i : i + 3]):
            exit_speed = 0.0
        if curve.length > SHORTEST:
            portion = Portion(curve.length, line.speed, line.acceleration, exit_speed)
            found.append(Stretch(curve, portion, first + i))
        if cuts[i + 1]:
            found.append(_corner(poses[i : i + 3], cuts[i + 1], line, lines[i + 1], first + i))
    return found


def line_run(
    arm: Arm, run: Sequence[Stretch], entry_speed: float, q_start: Array, branch: Branch, limits: MoveLimits
) -> Trajectory:
    """The joint reference along stretches, slowed as a whole until every joint keeps its limits.

    Raises:
        MoveRefused: the way leaves the arm's reach, a joint's range or the branch.
    """
    speeds = border_speeds([stretch.portion for stretch in run], entry_speed)
    times, rates, points, segments = _timed(run, speeds)
    q = _joint_positions(arm, points, q_start, branch)
    v, a = _joint_rates(arm, q, points, rates)
    slow = _slowing(v, a, limits)
    if not slow < LARGEST_SLOWING:
        raise MoveRefused(
            f"the line passes so near to a singular posture that it would take {slow:.0f} times longer"
        )
    return Trajectory(slow * times, q, v / slow, a / slow**2, segments)


def _timed(
    run: Sequence[Stretch], speeds: Sequence[float]
) -> tuple[Array, Array, CurvePoints, npt.NDArray[np.int64]]:
    """Times, way rates `(T, 2)` (speed and acceleration), curve points and segments of all rows."""
    times, rates, points, segments, elapsed = [], [], [], [], 0.0
    for i, stretch in enumerate(run):
        profile = portion_profile(stretch.portion, speeds[i], speeds[i + 1])
        rows = grid(profile.duration)[bool(i) :]
        states = np.array([profile.at_time(float(time)) for time in rows])[:, :, 0]
        times.append(elapsed + rows)
        rates.append(states[:, 1:])
        points.append(stretch.curve.at(np.clip(states[:, 0], 0.0, stretch.portion.length)))
        segments.append(np.full(len(rows), stretch.segment))
        elapsed += profile.duration
    return np.concatenate(times), np.concatenate(rates), _joined(points), np.concatenate(segments)


def _joined(points: Sequence[CurvePoints]) -> CurvePoints:
    names = [field.name for field in fields(CurvePoints)]
    return CurvePoints(*(np.concatenate([getattr(part, name) for part in points]) for name in names))


def _joint_positions(arm: Arm, points: CurvePoints, q_start: Array, branch: Branch) -> Array:
    q, rows = q_start, np.empty((len(points.p), arm.chain.n))
    for i, (R, p) in enumerate(zip(points.R, points.p, strict=True)):
        found = arm.inverse.follow_matrix(R, p, q, branch)
        if found is None:
            raise MoveRefused(f"the line is out of the arm's reach or joint range at {p.round(3).tolist()} m")
        if np.abs(found - q).max() > LARGEST_STEP:
            raise MoveRefused(f"the line passes a singular posture at {p.round(3).tolist()} m")
        rows[i] = q = found
    return rows


def _joint_rates(arm: Arm, q: Array, points: CurvePoints, rates: Array) -> tuple[Array, Array]:
    ds, dds = rates[:, :1], rates[:, 1:]
    slope = np.hstack([points.dp, points.turn])
    bend = np.hstack([points.ddp, np.zeros_like(points.turn)])
    return arm.chain.joint_rates(q, slope * ds, slope * dds + bend * ds**2)


def _slowing(v: Array, a: Array, limits: MoveLimits) -> float:
    """By what factor the run must take longer."""
    speed = float((np.abs(v) / limits.velocity).max())
    return max(1.0, speed, float(np.sqrt((np.abs(a) / limits.acceleration).max())))


def _straight(X_start: Pose, X_end: Pose, cut_start: float, cut_end: float) -> StraightCurve:
    if not cut_start and not cut_end:
        return StraightCurve(X_start, X_end)
    return trimmed(X_start, X_end, (cut_start, cut_end))


def _cut(poses: Sequence[Pose], line: Line) -> float:
    """How much of two lines a corner takes: at most half of the shorter."""
    if not line.blend or not line.exit_speed or _is_in_line(poses):
        return 0.0
    if max(angle_between(poses[0].q, poses[1].q), angle_between(poses[1].q, poses[2].q)) > IN_LINE:
        raise MoveRefused(
            f"'{line.label}' is blended though the tool turns along it or after it; set blend to 0"
        )
    lengths = [float(np.linalg.norm(b.p - a.p)) for a, b in ((poses[0], poses[1]), (poses[1], poses[2]))]
    return min(line.blend, 0.5 * min(lengths))


def _corner(poses: Sequence[Pose], cut: float, line: Line, after: Line, segment: int) -> Stretch:
    before, corner, last = (pose.p for pose in poses)
    start = corner + cut * (before - corner) / np.linalg.norm(before - corner)
    end = corner + cut * (last - corner) / np.linalg.norm(last - corner)
    curve = CornerCurve(np.array([start, corner, end]), poses[1].q)
    acceleration = min(line.acceleration, after.acceleration)
    speed = min(line.exit_speed, after.speed, float(np.sqrt(acceleration / curve.sharpest)))
    return Stretch(curve, Portion(curve.length, speed, acceleration, speed), segment)


def _is_in_line(poses: Sequence[Pose]) -> bool:
    """Whether two lines go on in the same direction, turning alike."""
    first, second = (StraightCurve(poses[i], poses[i + 1]) for i in (0, 1))
    if min(first.length, second.length) < SHORTEST:
        return False
    bend, twist = first.direction - second.direction, first.turn - second.turn
    return bool(np.linalg.norm(bend) < IN_LINE and np.linalg.norm(twist) < IN_LINE)
