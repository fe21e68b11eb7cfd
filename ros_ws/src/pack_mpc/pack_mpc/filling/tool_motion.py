"""Motions of the cup through free space: to an object, down on it, and away from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from pack_core.joints import Setpoints
from pack_core.kinematics.chain import chain_from_model
from pack_core.kinematics.redundant_follower import RedundantFollower
from pack_core.motion.moves import Line
from pack_core.packing.cell import PackingCell
from pack_core.robots.pump import add_pump
from pack_core.rotations import POINTING_DOWN, Array, Pose, conjugate, exp, log, multiply, yaw_of
from pack_motion.reference.curve import JERK_TIME, RADIUS, SHORTEST, CurveSegment, curve_segments
from pack_motion.reference.joint_move import MoveLimits
from pack_motion.reference.line_run import LineRefused, line_run
from pack_mpc.filling.fill_config import FillConfig

PERIOD = 0.02
"""Time between two rows of a motion [s]."""
SENT = 0.3
"""Length of what is sent to the driver at once [s]; it must outlast the time between two sendings."""
SHORTER = 0.005
"""Where the arm cannot follow a path, the motion ends this far before [m]."""


@dataclass(frozen=True)
class CupPace:
    """Largest speed [m/s] and acceleration [m/s^2] of the cup."""

    speed: float
    acceleration: float


def lines(
    X_WT: Pose, ways: Sequence[Array], pace: CupPace, config: FillConfig, q_end: Array | None = None
) -> list[Line]:
    """Lines of the cup, one after the other, along which it turns evenly.

    Args:
        X_WT: where the cup is.
        ways: displacements `(3,)` [m].
        pace: of the cup.
        config: how corners are rounded.
        q_end: orientation of the cup at the end; None: as it is.
    """
    turn = np.zeros(3) if q_end is None else log(multiply(q_end, conjugate(X_WT.q)))
    lengths = [float(np.linalg.norm(way)) for way in ways]
    total = max(sum(lengths), SHORTEST)
    # Where the turn takes longer than the way, the cup's speed is no steady one: corners are stops then.
    is_rounded = RADIUS * np.linalg.norm(turn) < total
    p, share, found = X_WT.p, 0.0, []
    for way, length in zip(ways, lengths, strict=True):
        p, share = p + way, share + length / total
        line = Line(Pose(p, multiply(exp(share * turn), X_WT.q)), pace.speed, pace.acceleration)
        if is_rounded:
            line = replace(line, exit_speed=config.corner_speed, blend=config.corner)
        found.append(line)
    X_end = Pose(p, X_WT.q if q_end is None else q_end)
    found[-1] = replace(found[-1], X_WT=X_end, exit_speed=0.0, blend=0.0)
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
        self._follower = RedundantFollower(self._chain, arm.limits.lower, arm.limits.upper, self._home)

    def cup(self, q: Array) -> Pose:
        """X_WT of the cup at joint positions `(7,)`."""
        return self._chain.forward(q)

    @property
    def home_heading(self) -> float:
        """Heading of the cup, turned upright, at the arm's home pose [rad]."""
        return yaw_of(multiply(self.cup(self._home).q, POINTING_DOWN))

    def plan(self, q: Array, start: float, path: Sequence[Line]) -> CupMotion:
        """The motion along a path, as far as the arm can follow it.

        Args:
            q: where the arm is `(7,)` [rad], at rest.
            start: time at which it begins [s].
            path: lines of the cup.
        """
        q = np.clip(q, self._limits.lower, self._limits.upper)
        limits = MoveLimits(
            self._limits.velocity, self._limits.acceleration, self._limits.acceleration / JERK_TIME
        )
        run = curve_segments(self.cup(q), path, 0)
        while run:
            try:
                reference = line_run(self._follower, run, 0.0, q, limits)
                break
            except LineRefused as refusal:
                run = _cut(run, refusal.length - SHORTER)
        else:
            zero = np.zeros((2, len(q)))
            return CupMotion(start, zero + q, zero, zero)
        times = PERIOD * np.arange(int(np.ceil(reference.duration / PERIOD)) + 1)
        states = [reference.at(float(time))[0] for time in times]
        qs, v, a = (np.array([getattr(state, name) for state in states]) for name in ("q", "v", "a"))
        return CupMotion(start, qs, v, self._torques(qs, v, a))

    def _torques(self, q: Array, v: Array, a: Array) -> Array:
        """Inverse dynamics without gravity `(T, 7)` [N m], within the joints' limits."""
        tau, data = np.empty_like(q), self._data
        for i in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
            mujoco.mj_inverse(self._model, data)
            tau[i] = data.qfrc_inverse
        return np.clip(tau, -self._limits.effort, self._limits.effort)


def _cut(run: Sequence[CurveSegment], length: float) -> list[CurveSegment]:
    """The first `length` [m] of a path, to a stop there."""
    kept: list[CurveSegment] = []
    for segment in run:
        limits = segment.limits
        if length < limits.length:
            if length > 0.0:
                kept.append(replace(segment, limits=replace(limits, length=length, exit_speed=0.0)))
            break
        kept.append(segment)
        length -= limits.length
    return kept
