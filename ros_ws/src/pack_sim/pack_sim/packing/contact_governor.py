"""The contact governor: while the held object touches something, it bounds how hard the driver presses.

An impact at the speed of free motion is over before the planner can react: the damping of Eq. 4 alone turns
0.35 m/s into about 80 N. So the governor runs in the driver, at the driver's rate. It does nothing in free
motion, where bounds would only make the arm late.
"""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from pack_core.config import Config
from pack_core.kinematics.damping import damped_square
from pack_core.rotations import Array

HOLD_TARE_TIME = 0.05
"""Time constant of the bias estimate while the arm is held [s]."""
HOLDS_DOWN = 0.7
"""A contact whose unit force has a downward part over this holds the object down: within 45 degrees of it."""
AT_REST = 0.01
"""Speed into the contact below which the cup rests against it [m/s]."""
TINY = 1e-9
"""Guards divisions by the magnitude of a force [N]."""


class ContactGovernorConfig(Config):
    """Bounds while there is contact; they hold for the wrench that the driver exerts on the cup."""

    trigger: PositiveFloat = Field(
        default=4.0, description="external force that counts as contact [N]; .inf: the driver bounds nothing"
    )
    tare_time: PositiveFloat = Field(
        default=0.5, description="time constant of the bias estimate in free motion [s]"
    )
    bias: PositiveFloat = Field(default=3.0, description="largest bias that the sensor can have [N]")
    draw_back: PositiveFloat = Field(
        default=0.03, description="way back after which a contact must have ended [m]"
    )
    latch: NonNegativeFloat = Field(default=0.15, description="time for which a contact is remembered [s]")
    filter_time: PositiveFloat = Field(
        default=0.005, description="time constant of the filter of the measured force [s]"
    )
    force: PositiveFloat = Field(
        default=28.0, description="largest force of the driver sideways, and down [N]"
    )
    bending: PositiveFloat = Field(
        default=4.0, description="measured load on the cup from which the arm gives way [N m]"
    )
    bending_limit: PositiveFloat = Field(
        default=6.0, description="load at which the arm presses no more; beyond, it pulls back [N m]"
    )
    push: PositiveFloat = Field(
        default=25.0, description="largest push of the driver against the measured force [N]"
    )
    pull_out: PositiveFloat = Field(
        default=30.0, description="largest pull against a force that holds the object down [N]"
    )
    reflex: NonNegativeFloat = Field(
        default=3.0, description="by how much each newton measured beyond `push` or `pull_out` reduces it"
    )
    pull_back: NonNegativeFloat = Field(default=40.0, description="largest force away from the contact [N]")
    approach: PositiveFloat = Field(default=0.03, description="reference speed into the contact [m/s]")
    build_up: NonNegativeFloat = Field(
        default=0.3,
        description="by how much it grows each second vertically, while the cup rests there [m/s^2]",
    )

    @model_validator(mode="after")
    def _gives_way_before_its_limit(self) -> ContactGovernorConfig:
        if self.bending >= self.bending_limit:
            raise ValueError(
                f"bending is {self.bending}; allowed: less than bending_limit, {self.bending_limit}"
            )
        return self


class ContactGovernor:
    """Limits reference velocities and joint torques while there is contact.

    Args:
        config: bounds and time constants.
        timestep: step of the driver [s].
    """

    def __init__(self, config: ContactGovernorConfig, timestep: float) -> None:
        self._config = config
        self._timestep = timestep
        self._take(np.zeros(3))
        self._bending = 0.0
        self._bias = np.zeros(3)
        self._touched = -np.inf
        self._drawn_back = 0.0
        self._rested = 0.0

    def update(self, time: float, force: Array, bending: float, *, is_holding: bool) -> bool:
        """Update with the external force on the held object `(3,)` [N] and the cup's bending moment [N m].

        The force is in the world frame. The sensor's bias is estimated while the arm is held or moves freely.

        Returns:
            Whether there is contact, or was within the last `config.latch` seconds.
        """
        # first-order low-pass, discretised by backward Euler
        gain = self._timestep / (self._config.filter_time + self._timestep)
        self._bending += gain * (bending - self._bending)
        if is_holding:
            self._tare(force, HOLD_TARE_TIME)
            self._take(np.zeros(3))
            self._touched = -np.inf
            return False
        self._take(self._force + gain * (force - self._bias - self._force))
        if self._strength > self._config.trigger:
            self._touched = time
        is_free = time - self._touched > self._config.latch
        if is_free:
            self._drawn_back = self._rested = 0.0
            self._tare(force, self._config.tare_time)
        return not is_free

    def _take(self, force: Array) -> None:
        """Keep the filtered force `(3,)`, its magnitude, and the unit vector along which it pushes."""
        self._force, self._strength = force, _length(force)
        self._away = force / max(self._strength, TINY)

    def follow(self, velocity: Array) -> None:
        """Detect a bias that passes for a contact, from the cup's velocity `(3,)` [m/s].

        A contact ends when the cup yields. A force that has pushed the cup back by more than `draw_back` and
        still persists is taken for a bias of the sensor. How long the cup has been at rest is noted, too.
        """
        if self._strength <= self._config.trigger:
            return
        speed = float(self._away @ velocity)
        self._rested = self._rested + self._timestep if speed > -AT_REST else 0.0
        self._drawn_back = max(0.0, self._drawn_back + self._timestep * speed)
        if self._drawn_back > self._config.draw_back:
            self._bias = self._limited(self._bias + self._force)
            self._take(np.zeros(3))
            self._touched, self._drawn_back = -np.inf, 0.0

    def _tare(self, force: Array, tare_time: float) -> None:
        gain = self._timestep / (tare_time + self._timestep)
        self._bias = self._limited(self._bias + gain * (force - self._bias))

    def _limited(self, bias: Array) -> Array:
        """The bias, limited to `config.bias` [N] so that a slowly growing contact is not taken for one."""
        return bias * min(1.0, self._config.bias / max(_length(bias), TINY))

    def slow_down(self, v_d: Array, J: Array) -> Array:
        """The desired joint velocity `(7,)`, its speed into the contact limited; J is the cup's `(6, 7)`.

        The damping turns what is left of it into a push. An impact is met with `approach` alone. While the
        cup rests there, the speed may grow by `build_up` [m/s^2], as far as its vertical part brings it in.
        """
        if self._strength <= self._config.trigger or self._holds_down:
            return v_d
        speed = J[:3] @ v_d
        vertical = min(max(-float(speed[2] * self._away[2]), 0.0), self._config.build_up * self._rested)
        excess = -float(self._away @ speed) - self._config.approach - vertical
        if excess <= 0.0:
            return v_d
        linear = J[:3]
        # damped pseudo-inverse: the joint velocity that moves the cup away from the contact at 1 m/s
        retreat = linear.T @ np.linalg.solve(damped_square(linear), self._away)
        return np.asarray(v_d + excess * retreat)

    def bound(self, tau: Array, J: Array) -> Array:
        """Joint torques `(7,)` limited in how hard they press, and reduced where the load bends the cup."""
        wrench = _wrench(tau, J)
        scale = self._scale(wrench)
        if self._strength <= self._config.trigger:
            return scale * tau
        push = scale * float(-self._away @ wrench[:3])
        limit = self._config.pull_out if self._holds_down else self._config.push
        # like a spring: the harder the contact already is, the less push is allowed, down to a pull back
        beyond = max(self._strength - limit, 0.0)
        # and where the load bends the cup too far, a pull back relieves it
        allowed = min(limit - self._config.reflex * beyond, limit * self._room)
        allowed = max(allowed, -self._config.pull_back)
        # torques of a unit force away from the contact; the division makes the wrench change by the excess
        back = J[:3].T @ self._away
        return np.asarray(
            scale * tau + max(push - allowed, 0.0) / float(self._away @ _wrench(back, J)[:3]) * back
        )

    @property
    def _holds_down(self) -> bool:
        """Whether the contact pulls down, as when the object is wedged and is to be drawn out."""
        return bool(self._away[2] < -HOLDS_DOWN)

    def _scale(self, wrench: Array) -> float:
        """Factor on the arm's torques that bounds its push sideways and down; 0 at the limit of bending."""
        config = self._config
        sideways, down = float(np.hypot(wrench[0], wrench[1])), float(max(-wrench[2], 0.0))
        return max(self._room, 0.0) / max(1.0, sideways / config.force, down / config.force)

    @property
    def _room(self) -> float:
        """Share of the push that the load on the cup leaves: 1 up to `bending`, 0 at its limit, then less."""
        config = self._config
        return min((config.bending_limit - self._bending) / (config.bending_limit - config.bending), 1.0)


def _length(v: Array) -> float:
    """What `np.linalg.norm` gives, in a third of its time for one vector."""
    return math.sqrt(v @ v)


def _wrench(tau: Array, J: Array) -> Array:
    """The wrench `(6,)` of joint torques on the cup, by damped least squares."""
    return np.asarray(np.linalg.solve(damped_square(J), J @ tau))
