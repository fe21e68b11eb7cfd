"""The least time in which a plan's own path could be run: TOPP-RA (PyPI `toppra`), without limits of jerk.

Pham and Pham, "A new approach to time-optimal path parameterization based on reachability analysis", 2018.
The path is q(s); what is left free is s(t).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from pack_core.errors import ConfigError
from pack_core.extras import install_command
from pack_core.motion.moves import Line
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.curve import RADIUS
from pack_motion.reference.path_planner import MotionPlan

POINTS_PER_SEGMENT = 200
"""Points of the grid on which each segment of the path is timed."""
STANDING = 1e-7
"""Rows that are nearer than this to the last one are the same point of the path [rad]."""
SLOW = 1e-3
"""Share of the fastest row's speed below which a row does not tell the path's derivatives."""
CORNER = 0.05
"""Change of direction from which a point that the reference stands at is a corner [rad]."""
TINY, MANY = 1e-9, 1e6


def least_duration(arm: MotionArm, plan: MotionPlan, share: float) -> float | None:
    """The least duration [s] along a plan's path, from rest to rest or from its first velocity.

    The limits are the reference's own: `share` of the joints' velocities and accelerations, lowered as each
    segment asks, and the tool's speed and acceleration on lines. None where the path is a point, or where
    toppra finds no timing on the grid.

    Raises:
        ConfigError: toppra is not installed.
    """
    toppra = require_toppra()
    rows, points = plan.trajectory, _points(plan)
    if len(points) < 3:
        return None
    q, v, segment = rows.q[points], rows.v[points], rows.segment[points]
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))])
    slope, bend, stops = _derivatives(q, v, rows.a[points])
    tool = np.array([arm.chain.jacobian(row) @ along for row, along in zip(q, slope, strict=True)])
    # Length of a line per unit of s: of the tool's way, or of its turn, whichever is longer.
    reach = np.maximum(np.linalg.norm(tool[:, :3], axis=1), RADIUS * np.linalg.norm(tool[:, 3:], axis=1))
    speed, acceleration, tool_speed, tool_acceleration = _limits(arm, plan, share)[:, segment]
    fastest = np.minimum(
        (speed[:, None] * arm.limits.velocity / np.maximum(np.abs(slope), TINY)).min(axis=1),
        tool_speed / np.maximum(reach, TINY),
    )
    fastest[stops] = 0.0
    constraint = _path_constraint(
        toppra, np.column_stack([slope, reach]), np.column_stack([bend, np.gradient(reach, s)]),
        np.column_stack([acceleration[:, None] * arm.limits.acceleration, tool_acceleration]), fastest,
    )  # fmt: skip
    timing = toppra.algorithm.TOPPRA([constraint], toppra.SplineInterpolator(s, q), gridpoints=s)
    start = min(float(np.linalg.norm(v[0])), float(fastest[0]))
    _, rate, _ = timing.compute_parameterization(start, 0.0)
    if rate is None or not np.all(np.isfinite(rate)):
        return None
    # Between two points of the grid the acceleration of s is constant, so that its mean speed is the average.
    return float(np.sum(2.0 * np.diff(s) / (rate[1:] + rate[:-1])))


def _limits(arm: MotionArm, plan: MotionPlan, share: float) -> Array:
    """Of m segments `(4, m)`: shares of the joints' velocities and accelerations, and the tool's own."""
    return np.array([
        (share, share, part.speed, part.acceleration) if isinstance(part, Line)
        else (share * part.speed, share * part.acceleration, MANY, MANY)
        for part in plan.segments
    ]).T  # fmt: skip


def require_toppra() -> Any:
    """The module toppra, quiet.

    Raises:
        ConfigError: it is not installed.
    """
    try:
        import toppra
    except ImportError as error:
        raise ConfigError(
            f"the bound of durations needs toppra: {install_command('motion', '--no-deps')}"
        ) from error
    toppra.setup_logging("ERROR")
    return toppra


def _points(plan: MotionPlan) -> list[int]:
    """Rows of a plan's trajectory that are points along its path, thinned evenly within each segment."""
    rows = plan.trajectory
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rows.q, axis=0), axis=1))])
    kept = {0}
    for index in np.unique(rows.segment):
        own = np.flatnonzero(rows.segment == index)
        wanted = np.linspace(way[own[0]], way[own[-1]], POINTS_PER_SEGMENT)
        kept |= {int(row) for row in own[np.minimum(np.searchsorted(way[own], wanted), len(own) - 1)]}
    points: list[int] = []
    for row in sorted(kept):
        if not points or way[row] - way[points[-1]] > STANDING:
            points.append(row)
    return points


def _derivatives(q: Array, v: Array, a: Array) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
    """dq/ds and d2q/ds2 `(T, n)` at points of a path, and where it has a corner `(T,)`.

    Of a reference that moves, with v = q' s' and a = q' s'' + q'' s'^2, where s is the length in joint space.
    Where it stands, the slope is that to the next point; a corner is where that differs from the one before.
    """
    rate = np.linalg.norm(v, axis=1)
    moves = rate > SLOW * rate.max()
    ahead = np.diff(q, axis=0)
    ahead = np.vstack([ahead, ahead[-1:]]) / np.linalg.norm(np.vstack([ahead, ahead[-1:]]), axis=1)[:, None]
    slope = np.where(moves[:, None], v / np.maximum(rate, TINY)[:, None], ahead)
    across = a - np.sum(a * slope, axis=1)[:, None] * slope
    bend = np.where(moves[:, None], across / np.maximum(rate, TINY)[:, None] ** 2, 0.0)
    stops = np.zeros(len(q), dtype=bool)
    stops[1:-1] = ~moves[1:-1] & (np.linalg.norm(np.diff(ahead, axis=0)[:-1], axis=1) > CORNER)
    stops[1:] &= ~stops[:-1]  # of points in a row the first: between two stops no time would be enough
    return slope, bend, stops


def _path_constraint(toppra: Any, slope: Array, bend: Array, most: Array, fastest: Array) -> Any:
    """|slope s'' + bend s'^2| <= most and s' <= fastest at every point of the grid, in toppra's form."""
    n, m = slope.shape

    class PathConstraint(toppra.constraint.LinearConstraint):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__()
            self.discretization_type = toppra.constraint.DiscretizationType.Collocation
            self.identical = False

        def compute_constraint_params(self, path: Any, gridpoints: Array, *_: Any) -> tuple[Any, ...]:
            F = np.broadcast_to(np.vstack([np.eye(m), -np.eye(m)]), (n, 2 * m, m))
            x = np.column_stack([np.zeros(n), fastest**2])
            return slope, bend, np.zeros((n, m)), F, np.hstack([most, most]), None, x

    return PathConstraint()
