"""What the wrench at the cup tells of the mass that hangs there, with a sensor whose bias drifts.

A sensor that is off by newtons, as one is that estimates forces from joint torques, weighs an object of 3 N
at rest only for a moment after it was set to zero. But an object that is moved shows its mass by its inertia
as well. In the axes of the object N the wrench's force, less the described weight m_d g, is

    f = R_NW [ m_d g z - m (a_W + g z) ] + b

with the true mass m, the acceleration a_W of its centre of mass, and the sensor's bias b, which drifts. For a
given m, b is all that is unknown, and it is linear. So there is a Kalman filter of b for each of a few masses
and each of a few sizes that biases have, and the likelihoods of what is measured tell how probable each of
them is (a bank of filters: Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and
Navigation, 2001, 11.6). How large biases are the horizontal axes show, along which no weight acts. At any
time what hangs there may be lost, from when on the mass is 0.

While the load is right, a wrong one is named with a probability of at most p (1 - c) / (c (1 - p)), for the
prior p and the certainty c (Ville's inequality), as far as the sensor is as it is modelled.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array

GRAVITY = np.array([0.0, 0.0, 9.81])
"""What a mass that hangs still is borne with, per kilogram, in world axes [m/s^2]."""
SHARES = np.array([0.0, 0.25, 0.4, 0.6, 0.8, 1.0, 1.2, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0])
"""Masses that are told apart, as shares of the described one."""
NOTHING = 0
"""Row of the empty hand among them."""
LEAST, MOST = 0.5, 1.45
"""Shares of the described mass from which on it is another one: descriptions are off by a quarter."""
BIASES = np.array([0.1, 0.5, 1.5, 3.0])
"""Standard deviations that a sensor's bias may have [N]."""
BIAS_TIME = 5.0
"""Correlation time of the bias [s]."""
SWING_TIME = 0.3
"""Time in which what swings from a soft cup comes to rest after the arm has accelerated [s]."""


class LoadConfig(Config):
    """How sure a statement on the load has to be."""

    noise: PositiveFloat = Field(
        default=0.15, description="error of the mean force between two samples of the joints [N]"
    )
    misfit: PositiveFloat = Field(
        default=0.25, description="share of the inertial force by which it may be off within such an interval"
    )
    swing: NonNegativeFloat = Field(
        default=0.0,
        description="share by which it may be off while the object swings from a soft cup after the arm "
        "has accelerated; 0: a rigid cup",
    )
    prior: float = Field(default=1e-2, gt=0, lt=1, description="share of objects of another mass")
    loss_rate: PositiveFloat = Field(default=1e-2, description="losses that go unnoticed [1/s]")
    certainty: float = Field(
        default=0.99, gt=0, le=1, description="probability from which on a wrong mass is named; 1: never"
    )


class LoadEstimate:
    """Probabilities of masses, from forces and accelerations of what is held.

    Args:
        mass: as described [kg].
        config: how sure a statement has to be.
        zeroed_for: time since the sensor was set to zero with an empty cup [s]; infinite: it never was.
    """

    def __init__(self, mass: float, config: LoadConfig, zeroed_for: float = np.inf) -> None:
        self._described, self._config = mass, config
        self._masses = mass * SHARES
        is_right = (SHARES > LEAST) & (SHARES < MOST)
        self._is_wrong = ~is_right
        prior = np.where(is_right, (1.0 - config.prior) / is_right.sum(), config.prior / (~is_right).sum())
        # Rows: masses; columns: sizes of biases.
        self._weights = np.outer(prior, np.full(len(BIASES), 1.0 / len(BIASES)))
        self._means = np.zeros((*self._weights.shape, 3))
        # The bias was zero then.
        grown = 1.0 - np.exp(-2.0 * zeroed_for / BIAS_TIME)
        self._variances = np.tile(grown * BIASES**2, (len(SHARES), 1))
        self._swing = 0.0

    @property
    def wrong(self) -> float:
        """Probability that the mass is another one than described."""
        return float(self._weights[self._is_wrong].sum())

    @property
    def empty(self) -> float:
        """Probability that nothing hangs there."""
        return float(self._weights[NOTHING].sum())

    @property
    def mass(self) -> float:
        """Expected mass [kg]."""
        return float(self._weights.sum(axis=1) @ self._masses)

    def update(self, force: Array, R_NW: Array, a_W: Array, elapsed: float) -> None:
        """Take note of what was measured on average within an interval between two samples of the joints.

        Args:
            force: of the wrench, less the described weight, in axes of N `(3,)` [N].
            R_NW: orientation of the world's axes in N `(3, 3)`.
            a_W: acceleration of the object's centre of mass, without gravity, `(3,)` [m/s^2].
            elapsed: time since the last interval that was noted; of the first one its length [s].
        """
        self._lose(1.0 - np.exp(-self._config.loss_rate * elapsed))
        # The bias is an Ornstein-Uhlenbeck process.
        decay = np.exp(-elapsed / BIAS_TIME)
        self._means = decay * self._means
        variances = decay**2 * self._variances + (1.0 - decay**2) * BIASES**2
        expected = R_NW @ (self._described * GRAVITY) - np.outer(self._masses, R_NW @ (a_W + GRAVITY))
        innovations = force - expected[:, None, :] - self._means
        self._swing = max(float(np.linalg.norm(a_W)), self._swing * float(np.exp(-elapsed / SWING_TIME)))
        inertial = max(self._config.misfit * float(np.linalg.norm(a_W)), self._config.swing * self._swing)
        spread = variances + self._config.noise**2 + (self._described * inertial) ** 2
        # Each of the three axes is normal with the same variance.
        logs = -0.5 * (innovations**2).sum(axis=2) / spread - 1.5 * np.log(spread)
        gains = variances / spread
        self._means = self._means + gains[..., None] * innovations
        self._variances = (1.0 - gains) * variances
        # What has become impossible stays possible by the least there is: it may be all that explains a jump.
        weights = np.maximum(self._weights, np.finfo(float).tiny) * np.exp(logs - logs.max())
        self._weights = weights / weights.sum()

    def _lose(self, probability: float) -> None:
        """What hangs there may have been lost: its bias then is that of the mass before, in the mean."""
        came = probability * self._weights
        came[NOTHING] = self._weights[NOTHING]
        total = came.sum(axis=0)
        shares = came / np.maximum(total, np.finfo(float).tiny)
        mean = np.einsum("ms,msa->sa", shares, self._means)
        apart = ((self._means - mean) ** 2).mean(axis=2)
        self._variances[NOTHING] = (shares * (self._variances + apart)).sum(axis=0)
        self._means[NOTHING] = mean
        self._weights = (1.0 - probability) * self._weights
        self._weights[NOTHING] = total
