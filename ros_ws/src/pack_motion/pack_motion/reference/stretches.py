"""Turns consecutive lines into curves: straight on where directions agree, else a stop or a round corner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.motion.moves import Line
from pack_core.rotations import Pose, angle_between
from pack_motion.reference.curve import CornerCurve, Curve, StraightCurve, trimmed
from pack_motion.reference.refusal import MoveRefused
from pack_motion.reference.speed_profile import Portion

IN_LINE = 1e-4
"""Directions that differ by less count as equal [rad]."""
SHORTEST = 1e-6
"""Shorter lines are left out [m]."""


@dataclass(frozen=True)
class Stretch:
    """A curve, the limits of its speed, and the index of the segment of the path that it belongs to."""

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


def _straight(X_start: Pose, X_end: Pose, cut_start: float, cut_end: float) -> StraightCurve:
    if not cut_start and not cut_end:
        return StraightCurve(X_start, X_end)
    return trimmed(X_start, X_end, (cut_start, cut_end))


def _cut(poses: Sequence[Pose], line: Line) -> float:
    """Length that the corner cuts off both lines [m]: at most half of the shorter line."""
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
    # Centripetal acceleration v^2 kappa within the limit: v <= sqrt(a / kappa).
    speed = min(line.exit_speed, after.speed, float(np.sqrt(acceleration / curve.sharpest)))
    return Stretch(curve, Portion(curve.length, speed, acceleration, speed), segment)


def _is_in_line(poses: Sequence[Pose]) -> bool:
    """Whether two lines have the same direction and the same turn per length."""
    first, second = (StraightCurve(poses[i], poses[i + 1]) for i in (0, 1))
    if min(first.length, second.length) < SHORTEST:
        return False
    bend, twist = first.direction - second.direction, first.turn - second.turn
    return bool(np.linalg.norm(bend) < IN_LINE and np.linalg.norm(twist) < IN_LINE)
