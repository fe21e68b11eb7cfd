"""Inverse kinematics of an arm with more joints than six, along a path of its tool."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pack_core.kinematics import screws
from pack_core.kinematics.chain import SerialChain
from pack_core.kinematics.damping import damped_inverse
from pack_core.rotations import Array

CENTRING = 2.0
"""Share of the way home that joints go, as far as the tool leaves them free, for a metre or radian of it."""
LAG = 0.01
"""Where the tool stays behind its pose by more, the arm cannot follow [m], [rad]."""
STEEPEST = 15.0
"""Where a joint turns by more for a metre or radian of the tool, the posture is nearly singular [rad]."""


@dataclass(frozen=True)
class RedundantFollower:
    """Follows poses of the tool, a few millimetres from one to the next, with more joints than six.

    Each step is one of Newton's by damped least squares, which at such a distance is off by less than 0.1 mm;
    the next step makes up for it. Joints that the tool leaves free drift towards home.

    Attributes:
        chain: the arm and its tool.
        lower: joint limits `(n,)` [rad].
        upper: joint limits `(n,)` [rad].
        home: joint positions that it drifts to `(n,)` [rad].
    """

    chain: SerialChain
    lower: Array
    upper: Array
    home: Array

    def follow(self, R_WT: Array, p_WT: Array, q_near: Array) -> Array | None:
        """Joint positions near `q_near` `(n,)` that bring the tool to a pose; None where it cannot follow."""
        chain = self.chain
        R, d = chain.links(q_near)
        z, p = screws.world_axes(chain.axes, chain.points, R, d)
        p_here = R[-1] @ chain.p_WT + d[-1]
        J = screws.jacobian(z, p, p_here, chain.n - 1)
        error = np.concatenate([p_WT - p_here, _turn(R_WT @ (R[-1] @ chain.R_WT).T)])
        far = float(np.linalg.norm(error))
        inverse = damped_inverse(J)
        pull = CENTRING * far * (self.home - q_near)
        step = inverse @ (error - J @ pull) + pull  # the pull, but for what of it would move the tool
        q = np.clip(q_near + step, self.lower, self.upper)
        # what the damping leaves of the error, and joints at their limits
        left = float(np.linalg.norm(error - J @ (q - q_near)))
        if left > LAG or np.abs(q - q_near).max() > STEEPEST * far:
            return None
        return q

    def follow_rows(self, R_WT: Array, p_WT: Array, q_start: Array) -> Array:
        """Joint positions `(k, n)` along T poses of the tool, up to the first that it cannot follow to.

        Args:
            R_WT: orientations `(T, 3, 3)`.
            p_WT: positions `(T, 3)` [m].
            q_start: joint positions where the arm is `(n,)` [rad].
        """
        rows = [np.asarray(q_start, dtype=float)]
        for R, p in zip(R_WT, p_WT, strict=True):
            found = self.follow(R, p, rows[-1])
            if found is None:
                break
            rows.append(found)
        return np.array(rows[1:]).reshape(-1, len(q_start))

    def joint_rates(self, times: Array, q: Array, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        """Joint velocities and accelerations `(T, n)` of rows, from their differences."""
        v = np.gradient(q, times, axis=0, edge_order=2)
        return v, np.gradient(v, times, axis=0, edge_order=2)


def _turn(R: Array) -> Array:
    """The rotation vector `(3,)` of a rotation by a small angle: its axis times the sine of the angle."""
    return 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
