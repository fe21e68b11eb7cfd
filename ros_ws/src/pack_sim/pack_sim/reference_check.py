"""Whether a joint reference can be followed at all."""

from __future__ import annotations

import numpy as np

from pack_core.errors import MessageError
from pack_core.joint_reference import JointReference
from pack_core.robots.joint_limits import JointLimits

SLACK = 1e-3
"""Share of a limit that a reference may exceed it by: rounding, and rows between which it is a cubic."""


def check_limits(reference: JointReference, limits: JointLimits) -> None:
    """See that a reference is whole and within the joints' limits.

    Raises:
        MessageError: wrong size, not finite, out of order, or beyond a limit.
    """
    offsets, n = reference.offsets, len(limits)
    rows = len(offsets)
    if rows == 0 or not np.all(np.isfinite(offsets)) or np.any(np.diff(offsets) <= 0):
        raise MessageError("times of a reference must be finite, rise, and number at least one")
    for what, values, lower, upper, unit in (
        ("position", reference.q, limits.lower, limits.upper, "rad"),
        ("velocity", reference.v, -limits.velocity, limits.velocity, "rad/s"),
        ("acceleration", reference.a, -limits.acceleration, limits.acceleration, "rad/s^2"),
    ):
        if values.shape != (rows, n):
            raise MessageError(f"{what}s have shape {values.shape}; allowed: ({rows}, {n})")
        if not np.all(np.isfinite(values)):
            raise MessageError(f"a {what} is not finite")
        slack = SLACK * np.abs(upper)
        beyond = (values < lower - slack) | (values > upper + slack)
        if np.any(beyond):
            row, joint = np.argwhere(beyond)[0]
            raise MessageError(
                f"{what} of {limits.names[joint]} is {values[row, joint]:.3f} {unit}; "
                f"allowed: {lower[joint]:.3f} to {upper[joint]:.3f}"
            )
