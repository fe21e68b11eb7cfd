"""Jerk-limited speed profiles along consecutive portions of a curve, without a stop between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ruckig

from pack_motion.arm.arm import JERK_TIME
from pack_motion.reference.fastest import fastest
from pack_motion.reference.refusal import MoveRefused

OVERSHOOT = 1e-6
"""A profile may overrun the ends of its portion by this, for rounding [m]."""
BISECTIONS = 40
"""Number of halvings of the interval in which a speed is searched."""


@dataclass(frozen=True)
class Portion:
    """A part of the curve with limits of its own.

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


def change_length(portion: Portion, v_0: float, v_1: float) -> float:
    """Shortest length [m] for a change of speed from `v_0` to `v_1` [m/s] within the portion's limits."""
    change, a = abs(v_1 - v_0), portion.acceleration
    # The acceleration rises and falls within JERK_TIME each. If the change is large enough it stays at its
    # largest value between, else it turns at a lower peak. By symmetry the mean speed is (v_0 + v_1) / 2.
    has_plateau = change >= a * JERK_TIME
    time = change / a + JERK_TIME if has_plateau else 2.0 * np.sqrt(change / portion.jerk)
    return float(0.5 * (v_0 + v_1) * time)


def border_speeds(portions: Sequence[Portion], entry_speed: float) -> list[float]:
    """The highest feasible speeds at all borders between portions, first and last included [m/s].

    Each starts from its limit. A backward pass lowers speeds from which the portion after cannot brake in
    time, a forward pass those that cannot be reached from the border before.
    """
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
    """Arc length over time along one portion, entered at `v_0` and left at `v_1` [m/s].

    Raises:
        MoveRefused: the speeds do not fit the length, so that the profile would overrun the portion's ends.
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
    """The highest speed up to `wished` at one end, with `fixed` at the other, that the length allows."""
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
