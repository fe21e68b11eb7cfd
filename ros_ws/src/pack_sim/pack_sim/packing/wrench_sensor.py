"""Errors of the force and torque sensor: white noise and a bias that drifts."""

from __future__ import annotations

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.rotations import Array


class WrenchSensorConfig(Config):
    """Standard deviations of the sensor's errors along each axis; 0 disables one."""

    force_noise: NonNegativeFloat = Field(
        default=0.0, description="white noise of the force, at every step of the physics [N]"
    )
    torque_noise: NonNegativeFloat = Field(default=0.0, description="white noise of the torque [N m]")
    force_bias: NonNegativeFloat = Field(default=0.0, description="bias of the force, which drifts [N]")
    torque_bias: NonNegativeFloat = Field(default=0.0, description="bias of the torque, which drifts [N m]")
    bias_time: PositiveFloat = Field(default=5.0, description="time after which the bias is another one [s]")


class WrenchSensor:
    """Adds the sensor's errors to a wrench.

    The bias is an Ornstein-Uhlenbeck process: normal at every instant, and correlated over `bias_time`. What
    it was when the sensor was last set to zero is subtracted.

    Args:
        config: standard deviations and correlation time.
        timestep: time between two calls of `advance` [s].
        rng: source of the errors.
    """

    def __init__(self, config: WrenchSensorConfig, timestep: float, rng: np.random.Generator) -> None:
        self._timestep, self._rng = timestep, rng
        # of the bias and of its value at the last zero, in standard deviations `(6,)`
        self._state, self._zero = rng.normal(size=6), np.zeros(6)
        self.configure(config)

    def configure(self, config: WrenchSensorConfig) -> None:
        """Have other errors from now on; the bias changes in proportion, so that a zero stays one."""
        self._noise = np.repeat([config.force_noise, config.torque_noise], 3)
        self._spread = np.repeat([config.force_bias, config.torque_bias], 3)
        self._is_exact = not (self._noise.any() or self._spread.any())
        self._memory = float(np.exp(-self._timestep / config.bias_time))
        self._error = self._spread * (self._state - self._zero)

    def zero(self) -> None:
        """Set the sensor to zero while nothing is on it, by a mean that has no noise to speak of."""
        self._zero = self._state.copy()
        self._error = np.zeros(6)

    def advance(self) -> None:
        """Draw the errors of the next time step."""
        if self._is_exact:
            return
        # exact discretisation of the Ornstein-Uhlenbeck process: the variance stays 1
        kick, noise = self._rng.normal(size=(2, 6))
        self._state = self._memory * self._state + np.sqrt(1.0 - self._memory**2) * kick
        self._error = self._spread * (self._state - self._zero) + self._noise * noise

    def read(self, force: Array, torque: Array) -> tuple[Array, Array]:
        """A force `(3,)` [N] and a torque `(3,)` [N m] with the errors of this time step."""
        if self._is_exact:
            return force, torque
        return force + self._error[:3], torque + self._error[3:]
