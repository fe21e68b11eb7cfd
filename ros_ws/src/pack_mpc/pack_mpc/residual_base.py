"""What a residual of the cost consists of: a name, a default weight, rows r and their derivatives.

The cost (Eq. 2) weighs residuals r(x, y) of the state x and of the sensor outputs y = h(x, u). Their
derivatives follow by the chain rule from those of the outputs, dy = C dx + D du. A residual therefore
states only its own slope: by the values of one sensor (`SensorResidual`), or by the state (`StateResidual`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.rotations import Array
from pack_mpc.ilqr import Linearization
from pack_mpc.norms import AnyNorm
from pack_mpc.plant import PackingPlant
from pack_mpc.target import PackingTarget


class ResidualOptions(Config):
    """How residuals are written where there is more than one way, and their norms.

    Attributes:
        upright: the upright residual as the angle of Table I, or as x and y of the object's z axis.
        force_dead_band: external force that costs nothing [N].
        norms: norm n_i of each residual by its name (Eq. 2); one that is not named is squared.
    """

    upright: Literal["angle", "axis"]
    force_dead_band: NonNegativeFloat
    norms: Mapping[str, AnyNorm] = Field(default_factory=dict)


class Residual(ABC):
    """One term of the cost.

    Attributes:
        name: key of its weight in `config/weights/*.yaml`.
        default_weight: weight of every row where a file names none.
        rows: length R of the residual vector.
        is_never_negative: whether it is written as a cost already, which the norm `linear` leaves as it is.
    """

    name: ClassVar[str]
    default_weight: ClassVar[float]
    is_never_negative: ClassVar[bool] = False
    rows: int

    def __init__(self, plant: PackingPlant, target: PackingTarget, options: ResidualOptions) -> None:
        self.plant, self.target, self.options = plant, target, options

    @abstractmethod
    def values(self, xs: Array, ys: Array) -> Array:
        """Residuals `(..., R)` of states `(..., nx)` and outputs `(..., ny)`."""

    @abstractmethod
    def jacobians(self, xs: Array, ys: Array, lin: Linearization, columns: np.ndarray) -> tuple[Array, Array]:
        """dr/dx `(T+1, R, n)` over the n state components `columns`, and dr/du `(T, R, m)`."""


class SensorResidual(Residual):
    """A residual of the three values of one sensor.

    Attributes:
        sensor: name of the sensor in the model.
    """

    sensor: ClassVar[str]

    def __init__(self, plant: PackingPlant, target: PackingTarget, options: ResidualOptions) -> None:
        super().__init__(plant, target, options)
        self._where = plant.sensor(self.sensor)

    @abstractmethod
    def of(self, y: Array) -> Array:
        """Residuals `(..., R)` of the sensor's values `(..., 3)`."""

    @abstractmethod
    def slope(self, y: Array) -> Array:
        """dr/dy `(T+1, R, 3)` at the sensor's values `(T+1, 3)`."""

    def values(self, xs: Array, ys: Array) -> Array:
        return self.of(ys[..., self._where])

    def jacobians(self, xs: Array, ys: Array, lin: Linearization, columns: np.ndarray) -> tuple[Array, Array]:
        slope = self.slope(ys[:, self._where])
        # D has no last step: the horizon ends with a state, which no control follows.
        return slope @ lin.C[:, self._where], slope[:-1] @ lin.D[:, self._where]


class StateResidual(Residual):
    """A residual of the state alone, so that dr/du = 0."""

    @abstractmethod
    def of(self, xs: Array) -> Array:
        """Residuals `(..., R)` of states `(..., nx)`."""

    @abstractmethod
    def slope(self, xs: Array, columns: np.ndarray) -> Array:
        """dr/dx `(T+1, R, n)` over the n state components `columns`."""

    def values(self, xs: Array, ys: Array) -> Array:
        return self.of(xs)

    def jacobians(self, xs: Array, ys: Array, lin: Linearization, columns: np.ndarray) -> tuple[Array, Array]:
        slope = self.slope(xs, columns)
        return slope, np.zeros((len(xs) - 1, slope.shape[1], lin.D.shape[2]))


def places(columns: np.ndarray, wanted: np.ndarray) -> list[int]:
    """Where state components are in the reduced state `columns`; empty if one of them is left out of it."""
    at = {int(column): i for i, column in enumerate(columns)}
    found = [at[int(component)] for component in wanted if int(component) in at]
    return found if len(found) == len(wanted) else []
