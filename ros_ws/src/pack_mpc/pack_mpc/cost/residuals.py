"""The residuals of the packing task, one class each (section III-A1): `RESIDUALS` lists them.

The whole cost of a horizon of T steps, with the weights w of the stage (Table I) and rows r:

    sum_t sum_i w_i n_i(r_i(x_t, y_t)) + sum_i w_f,i n_i(r_i(x_T, y_T)) + torque * sum_t |u_t|^2

with the norms n_i of `norms.py`: n_i(r) = r^2 unless the weights file names another. y = h(x, u) are the
sensor outputs. Derivatives of residuals follow by the chain rule from those of the outputs, dy = C dx + D du,
so a residual states only its own slope: by the values of one sensor (`SensorResidual`), or by the state
(`StateResidual`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.packing.model import HELD_POSITION, HELD_X_AXIS, HELD_Z_AXIS, TIP_FORCE
from pack_core.robots.seven_axis_arm import AXES
from pack_core.rotations import Array
from pack_mpc.cost.norms import AnyNorm
from pack_mpc.plant import Linearization, PackingPlant
from pack_mpc.target import PackingTarget

DISTANCE_MIN = 1e-6
"""The repulsion has a kink where obstacle and target coincide; a shorter distance counts as this one [m]."""
COSINE_MAX = 1.0 - 1e-9
"""The slope of arccos is infinite at 1."""


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
        measures: what it grows with, in words, for the descriptions of parameters.
        default_weight: weight of every row where a file names none.
        rows: length R of the residual vector.
        is_never_negative: whether it is written as a cost already, which the norm `linear` leaves as it is.
    """

    name: ClassVar[str]
    measures: ClassVar[str]
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


class Position(SensorResidual):
    """POS X, Y, Z: r = p_WN - p_target [m]; one weight an axis."""

    name, default_weight, rows, sensor = "position", 1.0, 3, HELD_POSITION
    measures = "the distance to the target"

    def of(self, y: Array) -> Array:
        return y - self.target.p_WN

    def slope(self, y: Array) -> Array:
        return np.broadcast_to(np.eye(3), (len(y), 3, 3))


class Upright(SensorResidual):
    """UP: tilt of the object's z axis z.

    As the angle of Table I, r = (arccos(z_z), 0), whose slope jumps at upright; or as the axis, smooth
    there: r = (z_x, z_y) - axis, with the target's own tilt as the zero.
    """

    name, default_weight, rows, sensor = "upright", 0.1, 2, HELD_Z_AXIS
    measures = "the held object's tilt"

    def of(self, y: Array) -> Array:
        if self.options.upright == "axis":
            return y[..., :2] - self.target.axis
        # The second row keeps the vector as long as that of the axis.
        return np.stack([np.arccos(_cosine(y)), np.zeros(y.shape[:-1])], axis=-1)

    def slope(self, y: Array) -> Array:
        if self.options.upright == "axis":
            return np.broadcast_to(np.eye(2, 3), (len(y), 2, 3))
        slope = np.zeros((len(y), 2, 3))
        slope[:, 0, 2] = -1.0 / np.sqrt(1.0 - _cosine(y) ** 2)
        return slope


def _cosine(z_axis: Array) -> Array:
    """Cosine of the tilt, kept off the ends where arccos has no finite slope."""
    return np.asarray(np.clip(z_axis[..., 2], -COSINE_MAX, COSINE_MAX))


class Yaw(SensorResidual):
    """Not in the paper: r = x . n = sin(yaw error), x the object's x axis, n normal to the wanted heading."""

    name, default_weight, rows, sensor = "yaw", 0.0, 1, HELD_X_AXIS
    measures = "the turn about the vertical"

    def of(self, y: Array) -> Array:
        return np.asarray((y @ self._normal)[..., None])

    def slope(self, y: Array) -> Array:
        return np.broadcast_to(self._normal, (len(y), 1, 3))

    @property
    def _normal(self) -> Array:
        return np.array([-np.sin(self.target.yaw), np.cos(self.target.yaw), 0.0])


class Force(SensorResidual):
    """EE FORCE: r = sign(f) max(|f| - dead band, 0) [N], f the external force at the tip, per axis.

    The sensor has the object's weight in it, too: f = weight - sensor, with the weight along the tip's z
    axis, as it is while the object hangs upright. Of one that is tilted by a, m g sin(a) counts as external.
    """

    name, default_weight, rows, sensor = "force", 0.0, 3, TIP_FORCE
    measures = "the contact force"

    def __init__(self, plant: PackingPlant, target: PackingTarget, options: ResidualOptions) -> None:
        super().__init__(plant, target, options)
        gravity = float(plant.model.opt.gravity[2])
        self._weight = np.array([0.0, 0.0, -gravity * plant.scene.new_object.mass])

    def of(self, y: Array) -> Array:
        external = self._weight - y
        return np.sign(external) * self._excess(external)

    def slope(self, y: Array) -> Array:
        # Zero within the dead band, -1 beyond it, as f = weight - sensor.
        return -(self._excess(self._weight - y) > 0.0).astype(float)[..., None] * np.eye(3)

    def _excess(self, external: Array) -> Array:
        return np.maximum(np.abs(external) - self.options.force_dead_band, 0.0)


class JointLimit(StateResidual):
    """RJL: r_i = cosh(q_i - (lower_i + upper_i) / 2) - 1, small in the middle and steep at the limits."""

    name, default_weight, rows = "joint_limit", 0.1, AXES
    measures = "nearness to joint limits"
    is_never_negative = True

    def of(self, xs: Array) -> Array:
        return np.asarray(np.cosh(xs[..., self.plant.layout.q] - self.plant.arm.limits.middle) - 1.0)

    def slope(self, xs: Array, columns: np.ndarray) -> Array:
        rows, q = np.zeros((len(xs), self.rows, len(columns))), self.plant.layout.q
        rows[:, np.arange(self.rows), places(columns, q)] = np.sinh(xs[:, q] - self.plant.arm.limits.middle)
        return rows


class JointVelocity(StateResidual):
    """RJV: r_i = dq_i/dt [rad/s]."""

    name, default_weight, rows = "joint_velocity", 0.02, AXES
    measures = "the joints' speeds"

    def of(self, xs: Array) -> Array:
        return xs[..., self.plant.layout.v]

    def slope(self, xs: Array, columns: np.ndarray) -> Array:
        rows = np.zeros((len(xs), self.rows, len(columns)))
        rows[:, np.arange(self.rows), places(columns, self.plant.layout.v)] = 1.0
        return rows


class ObstacleResidual(StateResidual):
    """OR: r_j = exp(-d_j), d_j [m] the horizontal distance of object j of the collision list from the target.

    It pushes the objects off the packing pose; its weight decays by Eq. 3 (`WeightSet.in_force`).
    """

    name, default_weight = "obstacle", 0.0
    measures = "nearness to other objects"
    is_never_negative = True

    def __init__(self, plant: PackingPlant, target: PackingTarget, options: ResidualOptions) -> None:
        super().__init__(plant, target, options)
        # A controller that is told of no objects (Uninformed Physics) has none of the list in its state.
        known = [plant.layout.object_p[name] for name in target.collisions if name in plant.layout.object_p]
        self._xy = np.array([p[:2] for p in known], dtype=int).reshape(-1, 2)
        self.rows = len(known)

    def of(self, xs: Array) -> Array:
        return np.exp(-self._offsets(xs)[1])

    def slope(self, xs: Array, columns: np.ndarray) -> Array:
        rows = np.zeros((len(xs), self.rows, len(columns)))
        offsets, distances = self._offsets(xs)
        # dr_j/dp_j = -exp(-d_j) (p_j - p_target) / d_j
        slopes = -np.exp(-distances)[..., None] * offsets / distances[..., None]
        for j, xy in enumerate(self._xy):
            # Objects that nothing touches are left out of the reduced state.
            if at := places(columns, xy):
                rows[:, j, at] = slopes[:, j]
        return rows

    def _offsets(self, xs: Array) -> tuple[Array, Array]:
        """Horizontal offsets `(..., R, 2)` of the obstacles from the target, and their lengths `(..., R)`."""
        offsets = xs[..., self._xy] - self.target.p_WN[:2]
        return offsets, np.maximum(np.linalg.norm(offsets, axis=-1), DISTANCE_MIN)


RESIDUALS: tuple[type[Residual], ...] = (
    Position,
    Upright,
    Yaw,
    Force,
    JointLimit,
    JointVelocity,
    ObstacleResidual,
)
"""Every residual, in the order of the rows. A new one is added here."""
