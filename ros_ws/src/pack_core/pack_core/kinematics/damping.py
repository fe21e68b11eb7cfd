"""Damped least squares: inverse kinematics that stays bounded near singular postures.

Nakamura and Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator
control", 1986, with a constant damping.
"""

from __future__ import annotations

import numpy as np

from pack_core.rotations import Array

DAMPING = 1e-4
"""Added to the squares of J's singular values, so that values below its root, 0.01, fade out."""


def damped_square(J: Array) -> Array:
    """J J' + d I `(m, m)` of a Jacobian `(m, n)`: like J J', but never singular."""
    return np.asarray(J @ J.T + DAMPING * np.eye(len(J)))


def damped_inverse(J: Array) -> Array:
    """The damped pseudo-inverse J' (J J' + d I)^-1 `(n, m)` of a Jacobian `(m, n)`."""
    return np.asarray(J.T @ np.linalg.inv(damped_square(J)))
