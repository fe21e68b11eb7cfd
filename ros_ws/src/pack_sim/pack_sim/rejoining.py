"""How an arm that its driver held follows references again: only from nearby, and within its limits."""

from __future__ import annotations

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import JointReference
from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array
from pack_sim.gentle_stop import Desired

PERIOD = 0.004
"""A reference may be as far from a held arm as its velocity limits allow in this time [s]."""
RATE = 15.0
"""Natural frequency of the critically damped approach to the reference [1/s]."""
SAME_POSITION, SAME_SPEED = 1e-6, 1e-4
"""Below these differences the arm follows the reference itself [rad, rad/s]."""


class Rejoining:
    """Leads a held arm to a reference, within the joints' velocity and acceleration limits."""

    def __init__(self, limits: JointLimits) -> None:
        self._limits = limits

    def check(self, reference: JointReference, time: float, held: Desired) -> None:
        """Check that a reference begins where the arm is held, or nearly there.

        One that begins up to `PERIOD` later than `time` [s] is compared with where the held arm is by then.

        Raises:
            MessageError: it is farther away than the velocity limits allow in `PERIOD`.
        """
        q, v, _ = held
        ahead = min(max(reference.time - time, 0.0), PERIOD)
        distance, most = reference.at(time + ahead)[0] - (q + ahead * v), PERIOD * self._limits.velocity
        joint = int(np.argmax(np.abs(distance) / most))
        if abs(distance[joint]) > most[joint]:
            raise MessageError(
                f"setpoints resumed, {self._limits.names[joint]} {distance[joint]:+.4f} rad from where the "
                f"arm was held without them; allowed: {most[joint]:.4f} rad, its velocity limit times "
                f"{1e3 * PERIOD:.0f} ms; plan again from the measured joints"
            )

    def step(
        self, reference: JointReference, time: float, before: float, last: Desired
    ) -> tuple[Desired, bool]:
        """The desired state at `time` after `last` at `before` [s], and whether that is the reference itself.

        The difference x to the reference decays by a = -RATE^2 x - 2 RATE dx/dt, which is critically damped;
        acceleration and velocity are clipped to their limits.
        """
        wanted = reference.at(time)
        h = time - before
        if h <= 0.0:
            return last, False
        (q_ref, v_ref, a_ref), (q, v, _) = wanted, last
        # Differences to the reference at `before`, extrapolated backwards from `time`.
        apart, slip = q - (q_ref - h * (v_ref - 0.5 * h * a_ref)), v - (v_ref - h * a_ref)
        if np.abs(apart).max() < SAME_POSITION and np.abs(slip).max() < SAME_SPEED:
            return wanted, True
        limits = self._limits
        a = _clip(a_ref - RATE * (RATE * apart + 2.0 * slip), limits.acceleration)
        v_new = _clip(v + h * a, limits.velocity)
        return (q + 0.5 * h * (v + v_new), v_new, (v_new - v) / h), False


def _clip(values: Array, limit: Array) -> Array:
    return np.asarray(np.clip(values, -limit, limit))
