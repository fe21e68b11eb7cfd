"""Checks that a joint reference is well formed and within the limits of the joints."""

from __future__ import annotations

import numpy as np

from pack_core.errors import MessageError
from pack_core.joints import JointReference
from pack_core.robots.joint_limits import JointLimits
from pack_core.rotations import Array

SLACK = 1e-3
"""A limit may be exceeded by this share of it, for rounding and for the cubic between rows."""


class ReferenceCheck:
    """Compares references with the limits of the joints."""

    def __init__(self, limits: JointLimits) -> None:
        self._names = limits.names
        self._bounds = [
            ("position", limits.lower, limits.upper, "rad"),
            ("velocity", -limits.velocity, limits.velocity, "rad/s"),
            ("acceleration", -limits.acceleration, limits.acceleration, "rad/s^2"),
        ]
        slacks = [SLACK * np.abs(upper) for _, _, upper, _ in self._bounds]
        self._least = np.array(
            [lower - slack for (_, lower, _, _), slack in zip(self._bounds, slacks, strict=True)]
        )
        self._most = np.array(
            [upper + slack for (_, _, upper, _), slack in zip(self._bounds, slacks, strict=True)]
        )

    def check(self, reference: JointReference) -> None:
        """Check that a reference is well formed and within the limits.

        Raises:
            MessageError: wrong size, not finite, out of order, or beyond a limit.
        """
        offsets, n = reference.offsets, len(self._names)
        rows = len(offsets)
        if rows == 0 or not np.isfinite(offsets).all() or (offsets[1:] <= offsets[:-1]).any():
            raise MessageError("times of a reference must be finite, rise, and number at least one")
        for k, values in enumerate((reference.q, reference.v, reference.a)):
            what = self._bounds[k][0]
            if values.shape != (rows, n):
                raise MessageError(f"{what}s have shape {values.shape}; allowed: ({rows}, {n})")
            if not np.isfinite(values).all():
                raise MessageError(f"a {what} is not finite")
            if (values < self._least[k]).any() or (values > self._most[k]).any():
                raise MessageError(self._worst(k, values))

    def _worst(self, k: int, values: Array) -> str:
        """An error text about the first value that is beyond its bounds."""
        what, lower, upper, unit = self._bounds[k]
        row, joint = np.argwhere((values < self._least[k]) | (values > self._most[k]))[0]
        return (
            f"{what} of {self._names[joint]} is {values[row, joint]:.3f} {unit}; "
            f"allowed: {lower[joint]:.3f} to {upper[joint]:.3f}"
        )
