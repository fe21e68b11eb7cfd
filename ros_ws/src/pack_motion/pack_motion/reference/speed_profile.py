"""How fast a way is travelled: jerk-limited, portion by portion, passing from one to the next at speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ruckig

from pack_motion.arm.arm import JERK_TIME
from pack_motion.reference.fastest import fastest
from pack_motion.reference.refusal import MoveRefused

OVERSHOOT = 1e-6
"""What a portion may be overrun by, for rounding [m]."""
BISECTIONS = 40


@dataclass(frozen=True)
class Portion:
    """A part of the way.

    Attributes:
        length: [m].
        speed: at most [m/s].
        acceleration: at most [m/s^2]; it is reached within `JERK_TIME`.
        exit_speed: at its end, at most [m/s].
    """

    length: float
    speed: float
    acceleration: float
    exit_speed: float

    @property
    def jerk(self) -> float:
        """At most [m/s^3]."""
        return self.acceleration / JERK_TIME


def change_length(portion: Portion, v_0: float, v_1: float) -> float:
    """How long the way is on which the speed changes from one to another [m]."""
    change, a = abs(v_1 - v_0), portion.acceleration
    has_plateau = change >= a * JERK_TIME
    time = change / a + JERK_TIME if has_plateau else 2.0 * np.sqrt(change / portion.jerk)
    return float(0.5 * (v_0 + v_1) * time)


def border_speeds(portions: Sequence[Portion], entry_speed: float) -> list[float]:
    """Speeds at all borders, first and last included, that can be kept to; each as wished or lower."""
    speeds = [min(entry_speed, portions[0].speed)]
    following = [*portions[1:], None]
    for portion, after in zip(portions, following, strict=True):
        limit = after.speed if after else portion.speed
        speeds.append(min(portion.exit_speed, portion.speed, limit))
    for i in reversed(range(len(portions))):
        speeds[i] = _reachable(portions[i], speeds[i + 1], speeds[i])
    for i, portion in enumerate(portions):
        speeds[i + 1] = _reachable(portion, speeds[i], speeds[i + 1])
    return speeds


def portion_profile(portion: Portion, v_0: float, v_1: float) -> ruckig.Trajectory:
    """Way over time along one portion.

    Raises:
        MoveRefused: it would be left at either end, as happens where the speeds at its ends do not fit.
    """
    request = ruckig.InputParameter(1)
    request.target_position, request.max_velocity = [portion.length], [max(portion.speed, v_0, v_1)]
    request.current_velocity, request.target_velocity = [v_0], [v_1]
    request.max_acceleration, request.max_jerk = [portion.acceleration], [portion.jerk]
    found = fastest(request)
    if found is None or not _is_inside(found, portion.length):
        raise MoveRefused(
            f"a line of {1000 * portion.length:.0f} mm cannot be entered at {v_0:.3f} m/s "
            f"and left at {v_1:.3f} m/s"
        )
    return found


def _is_inside(found: ruckig.Trajectory, length: float) -> bool:
    extent = found.position_extrema[0]
    return bool(extent.min >= -OVERSHOOT and extent.max <= length + OVERSHOOT)


def _reachable(portion: Portion, fixed: float, wished: float) -> float:
    """The speed up to `wished` at one end for which the portion is long enough, `fixed` at the other."""
    if wished <= fixed or change_length(portion, fixed, wished) <= portion.length:
        return wished
    near, far = fixed, wished
    for _ in range(BISECTIONS):
        middle = 0.5 * (near + far)
        if change_length(portion, fixed, middle) <= portion.length:
            near = middle
        else:
            far = middle
    return near
