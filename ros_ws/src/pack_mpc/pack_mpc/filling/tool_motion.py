"""Motions of the cup through free space: to an object, down on it, and away from it.

The cup's path is a sum of segments, each a straight displacement with a minimum-jerk profile. A segment may
begin before the one before it has ended, which rounds the corner between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.joints import Setpoints
from pack_core.kinematics import screws
from pack_core.kinematics.chain import chain_from_model
from pack_core.kinematics.damping import damped_inverse
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import UPSIDE_DOWN
from pack_core.robots.pump import add_pump
from pack_core.rotations import Array, Pose, angle_between, conjugate, exp, log, multiply, yaw_of

PERIOD = 0.02
"""Time between two rows of a motion [s]."""
SENT = 0.3
"""Length of what is sent to the driver at once [s]; it must outlast the time between two sendings."""
PEAK = 1.875
"""Peak speed of a minimum-jerk profile over its mean: the maximum of 30 s^2 - 60 s^3 + 30 s^4."""
SHORTEST = 0.2
"""No segment takes less [s], however short it is."""
CENTRING = 1.0
"""Rate at which joints drift to the home pose where the cup's pose leaves them free [1/s]."""
ROUNDS = 3
"""Newton steps of the inverse kinematics a row; the rows are near enough for errors below 0.1 mm."""
LAG, LAG_ANGLE = 0.01, 0.05
"""A motion ends where the cup would be farther from its path, as the arm cannot follow it [m], [rad]."""
LEAP = 2.0
"""And where a joint would be faster than this many times its limit, as near a singular posture."""


@dataclass(frozen=True)
class PathSegment:
    """A straight part of a path: the displacement `(3,)` [m] from `start` [s] on, over `duration` [s]."""

    way: Array
    start: float
    duration: float


def segments(ways: Sequence[Array], speed: float, overlap: float = 0.0) -> list[PathSegment]:
    """Segments one after the other, each begun when a share `overlap` of the one before is still to come.

    Args:
        ways: displacements `(3,)` [m].
        speed: largest speed of a segment [m/s].
        overlap: share of a segment's time, from 0 (stop at every corner) to below 1.
    """
    found: list[PathSegment] = []
    start = 0.0
    for way in ways:
        duration = max(SHORTEST, PEAK * float(np.linalg.norm(way)) / speed)
        found.append(PathSegment(way, start, duration))
        start += (1.0 - overlap) * duration
    return found


@dataclass(frozen=True)
class CupMotion:
    """A motion of the arm: joint positions, velocities and torques, a row every `PERIOD`, from `start` on.

    Attributes:
        start: time of the first row [s].
        q: `(T, 7)` [rad].
        v: `(T, 7)` [rad/s].
        tau: feed-forward torque `(T, 7)` [N m].
    """

    start: float
    q: Array
    v: Array
    tau: Array

    @property
    def end(self) -> float:
        """Time of the last row [s]."""
        return self.start + PERIOD * (len(self.q) - 1)

    def setpoints(self, time: float) -> Setpoints:
        """The rows from `time` [s] on; after the end the last position is held."""
        last = len(self.q) - 1
        first = max(int((time - self.start) / PERIOD), 0)
        rows = first + np.arange(round(SENT / PERIOD) + 1)
        is_over = (rows > last)[:, None]
        at = np.minimum(rows, last)
        return Setpoints(
            self.start + PERIOD * first, np.asarray(PERIOD * np.arange(len(rows)), dtype=float), self.q[at],
            np.where(is_over, 0.0, self.v[at]), np.where(is_over, 0.0, self.tau[at]),
        )  # fmt: skip


class ToolArm:
    """The arm with its empty cup: kinematics, and the torques that its masses need.

    Args:
        cell: the cell's physical facts.
    """

    def __init__(self, cell: PackingCell) -> None:
        spec = mujoco.MjSpec()
        spec.compiler.degree = False
        arm = cell.robot.arm
        add_pump(arm.add_to(spec), cell.pump, arm.flange)
        spec.option.gravity = (0.0, 0.0, 0.0)  # the driver compensates it
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._chain = chain_from_model(self._model, arm.joints, "tool")
        self._limits, self._home = arm.limits, np.array(cell.robot.home)

    def cup(self, q: Array) -> Pose:
        """X_WT of the cup at joint positions `(7,)`."""
        return self._chain.forward(q)

    @property
    def home_heading(self) -> float:
        """Heading of the cup, turned upright, at the arm's home pose [rad]."""
        return yaw_of(multiply(self.cup(self._home).q, np.array(UPSIDE_DOWN)))

    def plan(
        self, q: Array, start: float, path: Sequence[PathSegment], q_WT: Array | None = None
    ) -> CupMotion:
        """The motion along a path, as far as the arm can follow it.

        Args:
            q: where the arm is `(7,)` [rad].
            start: time at which it begins [s].
            path: segments, in the world's axes.
            q_WT: orientation of the cup at the end; None: as it is.
        """
        q = np.clip(q, self._limits.lower, self._limits.upper)
        X_WT = self.cup(q)
        end = max(segment.start + segment.duration for segment in path)
        turn = np.zeros(3) if q_WT is None else log(multiply(q_WT, conjugate(X_WT.q)))
        rows = [q]
        for t in PERIOD * np.arange(1, int(np.ceil(end / PERIOD)) + 1):
            shift = sum(
                (_profile((t - segment.start) / segment.duration) * segment.way for segment in path),
                np.zeros(3),
            )
            wanted = Pose(X_WT.p + shift, multiply(exp(_profile(t / end) * turn), X_WT.q))
            row = self._follow(rows[-1], wanted)
            leap = float(np.max(np.abs(row - rows[-1]) / self._limits.velocity)) / PERIOD
            if leap > LEAP or not _is_near(self.cup(row), wanted):
                rows.append(rows[-1])
                break
            rows.append(row)
        qs = np.array(rows)
        v = np.gradient(qs, PERIOD, axis=0)
        v[0], v[-1] = 0.0, 0.0
        a = np.gradient(v, PERIOD, axis=0)
        limit = self._limits.velocity
        return CupMotion(start, qs, np.clip(v, -limit, limit), self._torques(qs, v, a))

    def _follow(self, q: Array, X_WT: Pose) -> Array:
        """Joint positions near `q` `(7,)` at which the cup is at X_WT, by damped least squares."""
        pull = CENTRING * PERIOD * (self._home - q)
        for k in range(ROUNDS):
            R, d = self._chain.links(q)
            z, p = screws.world_axes(self._chain.axes, self._chain.points, R, d)
            here = self.cup(q)
            J = screws.jacobian(z, p, here.p, len(q) - 1)
            error = np.concatenate([X_WT.p - here.p, log(multiply(X_WT.q, conjugate(here.q)))])
            inverse = damped_inverse(J)
            step = inverse @ error
            if k == 0:  # the motion that leaves the cup where it is
                step += pull - inverse @ (J @ pull)
            q = np.clip(q + step, self._limits.lower, self._limits.upper)
        return q

    def _torques(self, q: Array, v: Array, a: Array) -> Array:
        """Inverse dynamics without gravity `(T, 7)` [N m], within the joints' limits."""
        tau, data = np.empty_like(q), self._data
        for i in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
            mujoco.mj_inverse(self._model, data)
            tau[i] = data.qfrc_inverse
        return np.clip(tau, -self._limits.effort, self._limits.effort)


def _is_near(X_WT: Pose, wanted: Pose) -> bool:
    distance = float(np.linalg.norm(X_WT.p - wanted.p))
    return distance < LAG and float(angle_between(X_WT.q, wanted.q)) < LAG_ANGLE


def _profile(s: float) -> float:
    """Minimum-jerk progress from 0 to 1 over s from 0 to 1."""
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
