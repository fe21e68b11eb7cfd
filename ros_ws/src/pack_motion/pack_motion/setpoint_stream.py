"""Computes setpoints up to a horizon beyond each measurement, so that the driver never runs out of them."""

from __future__ import annotations

from collections import deque

import numpy as np
from pydantic import Field

from pack_core.config import Config
from pack_core.joints import JointSample, Setpoints
from pack_core.motion.target import MotionTarget
from pack_core.rotations import Array
from pack_motion.controller import MotionController

MEMORY = 256
"""Largest number of setpoints that are kept."""
REST_SPEED = 0.01
"""Below this speed a joint of a held arm counts as standing still [rad/s]."""


class StreamConfig(Config):
    """How far setpoints reach, and when an arm counts as held."""

    period: float = Field(default=0.004, gt=0, le=0.01, description="between setpoints [s]")
    horizon: float = Field(default=0.040, gt=0, le=0.2, description="of setpoints beyond the measurement [s]")
    deviation: float = Field(
        default=0.002, gt=0, le=0.1,
        description="a joint is held where it is farther from its setpoint than it can move in this time [s]",
    )  # fmt: skip


class SetpointStream:
    """Steps a controller to a horizon beyond each measurement.

    If measurements stop, or the arm is away from its setpoints, the driver has run out of setpoints and holds
    the arm. The stream then pauses until the arm stands still, and continues from there.

    Args:
        controller: a newly started controller.
        config: how far setpoints reach, and when an arm counts as held.
        velocity: velocity limits of the joints `(n,)` [rad/s].
        gap: between two measurements, for which the driver goes on by itself [s]; None: the horizon.
    """

    def __init__(
        self, controller: MotionController, config: StreamConfig, velocity: Array, gap: float | None = None
    ) -> None:
        self.controller = controller
        self._period, self._horizon = config.period, config.horizon
        self._gap = config.horizon if gap is None else gap
        self._deviation = config.deviation * velocity
        self._rested = np.inf
        self.left: MotionTarget | None = None
        """The rest of an interrupted move; set in the step in which the arm has come to rest."""
        self.interruption = ""
        """Why the stream pauses; set in the step in which the pause begins."""
        self.is_astray = False
        """Whether the pause began because the arm was not where its setpoints were, or was not heard of."""
        self.is_barred = False
        """Whether a held arm must not move on yet, even if it stands."""
        self._restart()

    def has_begun_anew(self, sample: JointSample) -> bool:
        """Whether time went back, as after a reset of the simulator."""
        return sample.time < self._rows[-1][0] - 2.0 * self._horizon

    def advance(self, sample: JointSample) -> Setpoints | None:
        """Setpoints from the last one that is due up to the horizon; None while the arm is held."""
        controller = self.controller
        self.left, self.interruption = None, ""
        gap = sample.time - self._rows[-1][0]
        if controller.is_held:
            controller.see(sample)
            if not self._has_rested(sample) or self.is_barred:
                return None
            self.left = controller.resume(sample.time, sample.q)
            self._restart()
        elif gap > self._gap and controller.is_standing:
            controller.wait(sample.time)
            self._restart()
        elif gap > self._gap:
            self.interrupt(f"no joint states for {gap + self._horizon:.2f} s")
            return None
        reference = self._rows_until(sample)
        apart = np.abs(reference.at(sample.time)[0] - sample.q)
        if np.any(apart > self._deviation):
            self.interrupt(f"a joint is {apart.max():.3f} rad from its setpoint")
            return None
        return reference

    def interrupt(self, reason: str) -> None:
        """Pause, as the arm does not follow; when it stands, the rest of the move is to be planned anew."""
        if not self.controller.is_held:
            self._pause(reason)
        self.is_astray = True

    def bar(self, reason: str) -> None:
        """Have the driver brake a moving arm for a reason; without one the move may go on."""
        self.is_barred = bool(reason)
        if reason and not self.controller.is_held and not self.controller.is_standing:
            self._pause(reason)

    def abandon(self, reason: str) -> None:
        """Give up the move and have the driver brake the arm; stand where it comes to rest."""
        if not self.controller.is_held:
            self._pause(reason)
        self.controller.stop()

    def _pause(self, reason: str) -> None:
        self._rested, self.interruption = np.inf, f"{reason}; the driver holds the arm"
        self.is_astray = False
        self.controller.hold(self.interruption)

    def _has_rested(self, sample: JointSample) -> bool:
        """Whether the arm has stood for longer than the last setpoints can last that the driver may have."""
        if np.abs(sample.v).max() > REST_SPEED:
            self._rested = np.inf
            return False
        self._rested = min(self._rested, sample.time)
        return sample.time - self._rested > 2.0 * self._horizon

    def _restart(self) -> None:
        self._rows = deque([(self.controller.time, self.controller.commanded)], maxlen=MEMORY)

    def _rows_until(self, sample: JointSample) -> Setpoints:
        while self.controller.time + self._period <= sample.time + self._horizon + 1e-9:
            state = self.controller.step(self.controller.time + self._period, sample)
            self._rows.append((self.controller.time, state))
        while len(self._rows) > 1 and self._rows[1][0] <= sample.time:
            self._rows.popleft()
        return self.given

    @property
    def given(self) -> Setpoints:
        """The setpoints that were given out and may not be over."""
        times = np.array([time for time, _ in self._rows])
        q, v, a = (np.array([getattr(state, name) for _, state in self._rows]) for name in ("q", "v", "a"))
        return Setpoints(float(times[0]), times - times[0], q, v, a=a)
