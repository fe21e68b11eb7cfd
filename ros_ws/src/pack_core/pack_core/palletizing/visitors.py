"""Visitors of the palletizing cell: people, vehicles and other robots that come near the arm, as capsules."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config, load_config
from pack_core.errors import ConfigError
from pack_core.paths import config_path
from pack_core.rotations import Array, Pose

Point = tuple[float, float, float]


@dataclass(frozen=True)
class VisitorMotion:
    """Where a visitor V is: pose X_WV of its middle, z along the capsule; velocity v_WV_W `(3,)` [m/s]."""

    X_WV: Pose
    v_WV_W: Array


class Visitor(Config):
    """A capsule that goes along a path and waits at its way-points, again and again."""

    name: str = Field(min_length=1, description="as reports call it")
    radius: PositiveFloat = Field(description="of the capsule [m]")
    length: PositiveFloat = Field(description="between the middles of its two round ends [m]")
    axis: Point = Field((0.0, 0.0, 1.0), description="direction of the capsule in the world; of any length")
    path: Annotated[tuple[Point, ...], Field(min_length=2)] = Field(
        description="way-points of its middle [m]"
    )
    speed: PositiveFloat = Field(description="between way-points, at most [m/s]")
    acceleration: PositiveFloat = Field(1.5, description="when it starts and stops [m/s^2]")
    pause: NonNegativeFloat = Field(0.0, description="at every way-point but the last [s]")
    start: NonNegativeFloat = Field(0.0, description="when it leaves its first way-point [s]")
    period: PositiveFloat | None = Field(None, description="after which it comes again [s]; none: only once")

    def at(self, time: float) -> VisitorMotion:
        """Pose and velocity at `time` [s]; before its start and after its end it stands."""
        since = time - self.start
        if self.period is not None and since > 0.0:
            since %= self.period
        points = [np.array(point) for point in self.path]
        for a, b in pairwise(points):
            way = float(np.linalg.norm(b - a))
            duration = _duration(way, self.speed, self.acceleration)
            if since < duration:
                s, rate = _travelled(max(since, 0.0), way, self.speed, self.acceleration)
                direction = (b - a) / way
                return VisitorMotion(Pose(a + s * direction, self._q_WV), rate * direction)
            since -= duration
            if since < self.pause:
                return VisitorMotion(Pose(b, self._q_WV), np.zeros(3))
            since -= self.pause
        return VisitorMotion(Pose(points[-1], self._q_WV), np.zeros(3))

    @property
    def duration(self) -> float:
        """Time from its start to its end of the path [s]."""
        ways = [float(np.linalg.norm(np.subtract(b, a))) for a, b in pairwise(self.path)]
        travel = sum(_duration(way, self.speed, self.acceleration) for way in ways)
        return travel + self.pause * (len(ways) - 1)

    @property
    def enclosing_size(self) -> Array:
        """Edge lengths `(3,)` [m] of the box around the capsule, in its own frame."""
        across = 2.0 * self.radius
        return np.array([across, across, self.length + across])

    @property
    def _q_WV(self) -> Array:
        """Quaternion wxyz that turns z onto the capsule's axis, the short way round."""
        axis = np.array(self.axis) / np.linalg.norm(self.axis)
        if axis[2] < -1.0 + 1e-9:  # half a turn: any horizontal axis of rotation will do
            return np.array([0.0, 1.0, 0.0, 0.0])
        # The half-way quaternion between two unit vectors u and w is (1 + u.w, u x w), normalised.
        q = np.array([1.0 + axis[2], -axis[1], axis[0], 0.0])
        return np.asarray(q / np.linalg.norm(q))


class Visitors(Config):
    """Everyone who comes near the arm in a run."""

    visitors: tuple[Visitor, ...] = ()


def load_visitors(name: str) -> tuple[Visitor, ...]:
    """The visitors of `config/visitors/<name>.yaml`; none for an empty name.

    Raises:
        ConfigError: there is no such file, or it has a key or value that is not allowed.
    """
    if not name:
        return ()
    path = config_path("visitors", f"{name}.yaml")
    if not path.is_file():
        known = sorted(file.stem for file in config_path("visitors").glob("*.yaml"))
        raise ConfigError(f"no visitors '{name}'; there are: {', '.join(known)} (config/visitors)")
    return load_config(Visitors, path).visitors


def _duration(way: float, speed: float, acceleration: float) -> float:
    """Time for a way from rest to rest [s]: a trapezoid of speed, or a triangle where the way is short."""
    if way * acceleration < speed**2:
        return 2.0 * float(np.sqrt(way / acceleration))
    return way / speed + speed / acceleration


def _travelled(time: float, way: float, speed: float, acceleration: float) -> tuple[float, float]:
    """Way [m] and speed [m/s] after `time` [s] on a way from rest to rest."""
    duration = _duration(way, speed, acceleration)
    peak = min(speed, float(np.sqrt(way * acceleration)))
    ramp = peak / acceleration
    if time < ramp:
        return 0.5 * acceleration * time**2, acceleration * time
    if time > duration - ramp:
        left = duration - time
        return way - 0.5 * acceleration * left**2, acceleration * left
    return 0.5 * acceleration * ramp**2 + peak * (time - ramp), peak
