"""What a robot moves among: boxes that stand or move, and the box in its hand."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pack_core.errors import PackError
from pack_core.rotations import Array, Pose


@dataclass(frozen=True)
class Obstacle:
    """A box-shaped body O that must not be touched.

    Attributes:
        name: what reports call it.
        X_WO: pose of its centre.
        size: full edge lengths `(3,)` [m].
        v_WO_W: velocity of its centre `(3,)` [m/s].
        is_moving: avoided while moving, from farther away; moves are not planned around it.
    """

    name: str
    X_WO: Pose
    size: Array
    v_WO_W: Array = field(default_factory=lambda: np.zeros(3))
    is_moving: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", _edges(self.size, self.name))

    def after(self, time: float) -> Obstacle:
        """The same body after `time` [s] at its velocity."""
        return replace(self, X_WO=Pose(self.X_WO.p + time * self.v_WO_W, self.X_WO.q))


@dataclass(frozen=True)
class CarriedBox:
    """The box B in the hand: pose of its centre in the tool's frame, full edge lengths `(3,)` [m]."""

    X_TB: Pose
    size: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", _edges(self.size, "the carried box"))

    @cached_property
    def corners(self) -> Array:
        """Its corners in the tool's frame `(8, 3)` [m]."""
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return self.X_TB.apply(0.5 * signs * self.size)


def _edges(size: Array, name: str) -> Array:
    edges = np.array(size, dtype=float)
    if edges.shape != (3,) or not np.all(np.isfinite(edges)) or np.any(edges <= 0.0):
        raise PackError(f"size of {name} is {edges.tolist()}; allowed: three positive edge lengths [m]")
    edges.setflags(write=False)
    return edges
