"""Turns consecutive lines of the tool into a joint reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np
import numpy.typing as npt

from pack_core.kinematics.inverse import Branch
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.reference.curve import CurvePoints
from pack_motion.reference.joint_move import MoveLimits
from pack_motion.reference.refusal import MoveRefused
from pack_motion.reference.speed_profile import border_speeds, portion_profile
from pack_motion.reference.stretches import Stretch
from pack_motion.reference.trajectory import ReferenceTrajectory, grid

LARGEST_STEP = 0.5
"""Largest step of a joint between rows [rad]; a larger one is a change of branch or a singular wrist."""

SOFTENINGS = 3
"""How often accelerations are lowered, stretch by stretch, before the run is slowed as a whole."""

FURTHER = 1.02

LARGEST_SLOWING = 20.0
"""Largest factor by which lines may be slowed to keep the joint limits; beyond it the move is refused."""


def line_run(
    arm: MotionArm,
    run: Sequence[Stretch],
    entry_speed: float,
    q_start: Array,
    branch: Branch,
    limits: MoveLimits,
) -> ReferenceTrajectory:
    """The joint reference along stretches, slowed as a whole until every joint keeps its limits.

    Raises:
        MoveRefused: the lines leave the arm's reach, a joint's range or the branch of the inverse
            kinematics, or pass too near to a singular posture.
    """
    for _ in range(SOFTENINGS + 1):
        speeds = border_speeds([stretch.portion for stretch in run], entry_speed)
        times, rates, points, owners = _timed(run, speeds)
        q = _joint_positions(arm, points, q_start, branch)
        v, a = _joint_rates(arm, q, points, rates)
        excess = np.abs(a / limits.acceleration).max(axis=1)
        if excess.max() <= 1.0:
            break
        run = _softened(run, owners, excess)
    segments = np.array([stretch.segment for stretch in run])[owners]
    slow = _slowing(v, a, limits)
    if not slow < LARGEST_SLOWING:  # written so that nan is refused too
        raise MoveRefused(
            f"the line passes so near to a singular posture that it would take {slow:.0f} times longer"
        )
    return ReferenceTrajectory(slow * times, q, v / slow, a / slow**2, segments)


def _softened(run: Sequence[Stretch], owners: npt.NDArray[np.int64], excess: Array) -> list[Stretch]:
    """The same stretches, with lower accelerations where a joint's acceleration is exceeded by a factor."""
    softened = []
    for i, stretch in enumerate(run):
        factor = float(excess[owners == i].max(initial=0.0))
        # A little more than the excess, as the part of it that comes from the speed does not shrink.
        factor = FURTHER * factor if factor > 1.0 else 1.0
        portion = replace(stretch.portion, acceleration=stretch.portion.acceleration / factor)
        softened.append(replace(stretch, portion=portion))
    return softened


def _timed(
    run: Sequence[Stretch], speeds: Sequence[float]
) -> tuple[Array, Array, CurvePoints, npt.NDArray[np.int64]]:
    """Of all rows: times, speed and acceleration on the curve `(T, 2)`, curve points, index of stretch."""
    times, rates, points, owners, elapsed = [], [], [], [], 0.0
    for i, stretch in enumerate(run):
        profile = portion_profile(stretch.portion, speeds[i], speeds[i + 1])
        rows = grid(profile.duration)[bool(i) :]  # from the second stretch on, row 0 is the last one's end
        states = np.array([profile.at_time(float(time)) for time in rows])[:, :, 0]
        times.append(elapsed + rows)
        rates.append(states[:, 1:])
        points.append(stretch.curve.at(np.clip(states[:, 0], 0.0, stretch.portion.length)))
        owners.append(np.full(len(rows), i))
        elapsed += profile.duration
    return np.concatenate(times), np.concatenate(rates), _joined(points), np.concatenate(owners)


def _joined(points: Sequence[CurvePoints]) -> CurvePoints:
    names = [field.name for field in fields(CurvePoints)]
    return CurvePoints(*(np.concatenate([getattr(part, name) for part in points]) for name in names))


def _joint_positions(arm: MotionArm, points: CurvePoints, q_start: Array, branch: Branch) -> Array:
    q, rows = q_start, np.empty((len(points.p), arm.chain.n))
    for i, (R, p) in enumerate(zip(points.R, points.p, strict=True)):
        found = arm.inverse.follow_matrix(R, p, q, branch)
        if found is None:
            raise MoveRefused(f"the line is out of the arm's reach or joint range at {p.round(3).tolist()} m")
        if np.abs(found - q).max() > LARGEST_STEP:
            raise MoveRefused(f"the line passes a singular posture at {p.round(3).tolist()} m")
        rows[i] = q = found
    return rows


def _joint_rates(arm: MotionArm, q: Array, points: CurvePoints, rates: Array) -> tuple[Array, Array]:
    ds, dds = rates[:, :1], rates[:, 1:]
    slope = np.hstack([points.dp, points.turn])
    bend = np.hstack([points.ddp, np.zeros_like(points.turn)])
    # Chain rule for the pose x(s(t)): dx/dt = x' ds/dt, and d2x/dt2 = x' d2s/dt2 + x'' (ds/dt)^2.
    return arm.chain.joint_rates(q, slope * ds, slope * dds + bend * ds**2)


def _slowing(v: Array, a: Array, limits: MoveLimits) -> float:
    """Factor k >= 1 by which the run must take longer: speeds fall with k, accelerations with k^2."""
    speed = float((np.abs(v) / limits.velocity).max())
    return max(1.0, speed, float(np.sqrt((np.abs(a) / limits.acceleration).max())))
