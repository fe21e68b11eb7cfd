"""A sensor that watches the space around the arm and tells where visitors are."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.motion.world import Obstacle
from pack_core.palletizing.visitors import Visitor
from pack_core.rotations import Array, Pose


class VisitorSensorConfig(Config):
    """A 3D safety camera over the cell.

    The figures are of the size that makers of such cameras state: 30 pictures a second, an answer after
    0.1 s, and a few centimetres of measuring error at ten metres, which tracking over several pictures
    brings down to about one.
    """

    period: PositiveFloat = Field(default=0.032, description="between two observations [s]")
    latency: NonNegativeFloat = Field(default=0.1, description="from an observation to its message [s]")
    noise: NonNegativeFloat = Field(default=0.01, description="of each coordinate, one sigma [m]")
    margin: NonNegativeFloat = Field(default=0.03, description="added to every side: three sigma [m]")
    reach: PositiveFloat = Field(default=6.0, description="from the arm's base; not seen farther away [m]")
    gate: PositiveFloat = Field(
        default=0.5, description="from where somebody was expected, from which on it is taken for another [m]"
    )
    smoothing: float = Field(default=0.4, gt=0, le=1, description="alpha of the alpha-beta filter")


@dataclass(frozen=True)
class Observation:
    """Visitors as seen at `time` [s]."""

    time: float
    obstacles: tuple[Obstacle, ...]


class VisitorSensor:
    """Observes visitors at a rate, late and with noise, and estimates velocities by an alpha-beta filter.

    Benedict and Bordner, "Synthesis of an optimal set of radar track-while-scan smoothing equations", 1962:
    the best beta for an alpha is alpha^2 / (2 - alpha).

    Args:
        visitors: who may be seen.
        config: rate, delay and errors.
        p_WB: position of the arm's base `(3,)` [m].
        seed: seed of the noise.
    """

    def __init__(
        self, visitors: Sequence[Visitor], config: VisitorSensorConfig, p_WB: Array, seed: int
    ) -> None:
        self._visitors, self._config, self._p_WB = tuple(visitors), config, p_WB
        self._rng = np.random.default_rng([seed, 7])
        self._tracks: dict[str, tuple[Array, Array]] = {}
        self._late: deque[Observation] = deque()
        self._next = 0.0

    def observe(self, time: float) -> Observation | None:
        """The newest observation whose message comes at `time` [s]; None when there is none."""
        if self._visitors and time >= self._next:
            self._next = time + self._config.period - 1e-9
            self._late.append(Observation(time, self._look(time)))
        found = None
        while self._late and time >= self._late[0].time + self._config.latency:
            found = self._late.popleft()
        return found

    def _look(self, time: float) -> tuple[Obstacle, ...]:
        c, seen = self._config, []
        for visitor in self._visitors:
            truth = visitor.at(time).X_WV
            if np.linalg.norm(truth.p - self._p_WB) > c.reach:
                self._tracks.pop(visitor.name, None)
                continue
            p, v = self._tracked(visitor.name, truth.p + self._rng.normal(0.0, c.noise, 3))
            size = visitor.enclosing_size + 2.0 * c.margin
            seen.append(Obstacle(visitor.name, Pose(p, truth.q), size, v, is_moving=True))
        return tuple(seen)

    def _tracked(self, name: str, measured: Array) -> tuple[Array, Array]:
        """Filtered position and velocity, each `(3,)`, after a measured position `(3,)`."""
        h, alpha = self._config.period, self._config.smoothing
        p, v = self._tracks.get(name, (measured, np.zeros(3)))
        predicted = p + h * v
        innovation = measured - predicted
        if np.linalg.norm(innovation) > self._config.gate:
            predicted, v, innovation = measured, np.zeros(3), np.zeros(3)
        beta = alpha**2 / (2.0 - alpha)
        self._tracks[name] = predicted + alpha * innovation, v + beta / h * innovation
        return self._tracks[name]
