"""The residuals of the packing task and their derivatives (section III-A1, Table I)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pack_core.packing.model import HELD_POSITION, HELD_X_AXIS, HELD_Z_AXIS, TIP_FORCE
from pack_core.robots.panda import LOWER, UPPER
from pack_core.rotations import Array
from pack_mpc.ilqr import Linearization
from pack_mpc.plant import PackingPlant
from pack_mpc.weights import Weights, WeightSet

MIDDLE = 0.5 * (LOWER + UPPER)
DISTANCE_MIN = 1e-6


@dataclass(frozen=True)
class Target:
    """Where the held object N shall go.

    Attributes:
        p_WN: position `(3,)` [m].
        yaw: heading [rad].
        axis: x and y `(2,)` of its z axis, zero for upright.
        over: horizontal direction `(2,)` to the obstacles, zero without a clear side.
        collisions: the collision list.
        may_land: whether the object may come down on top of another one, or of a wall, on its way.
        is_rehearsed: whether it is on an entry that was rehearsed.
    """

    p_WN: Array
    yaw: float
    axis: Array = field(default_factory=lambda: np.zeros(2))
    over: Array = field(default_factory=lambda: np.zeros(2))
    collisions: tuple[str, ...] = ()
    may_land: bool = False
    is_rehearsed: bool = False


class Residuals:
    """Residual vector r(x, y, u) with R rows, and dr/dx, dr/du by the chain rule.

    Rows: position 3, upright 2, yaw 1, force 3, joint limits 7, joint velocities 7, one an obstacle.
    """

    def __init__(self, plant: PackingPlant, weights: WeightSet, target: Target) -> None:
        self._plant, self._target = plant, target
        self._uses_angle = weights.upright == "angle"
        self._dead_band = weights.force_dead_band
        names = (HELD_POSITION, HELD_X_AXIS, HELD_Z_AXIS, TIP_FORCE)
        self._position, self._x_axis, self._z_axis, self._force = (plant.sensor(name) for name in names)
        self._obstacles = [name for name in target.collisions if name in plant.layout.object_p]
        gravity = float(plant.model.opt.gravity[2])
        self._weight = np.array([0.0, 0.0, -gravity * plant.scene.new_object.mass])

    def values(self, xs: Array, ys: Array) -> Array:
        """Residuals `(..., R)` of states `(..., nx)` and outputs `(..., ny)`."""
        position = ys[..., self._position] - self._target.p_WN
        upright, _ = self._upright(ys[..., self._z_axis])
        yaw = (ys[..., self._x_axis] @ self._heading_normal())[..., None]
        force, _ = self._soft_force(ys[..., self._force])
        joint_limit = np.cosh(xs[..., self._plant.layout.q] - MIDDLE) - 1.0
        joint_velocity = xs[..., self._plant.layout.v]
        obstacles = [np.exp(-self._offset(xs, name)[1])[..., None] for name in self._obstacles]
        return np.concatenate(
            [position, upright, yaw, force, joint_limit, joint_velocity, *obstacles], axis=-1
        )

    def jacobians(self, xs: Array, ys: Array, lin: Linearization, columns: np.ndarray) -> tuple[Array, Array]:
        """dr/dx `(T+1, R, n)` over the reduced state and dr/du `(T, R, 7)`."""
        _, upright = self._upright(ys[:, self._z_axis])
        _, force = self._soft_force(ys[:, self._force])
        normal = self._heading_normal()
        from_outputs = [
            (lin.C[:, self._position], lin.D[:, self._position]),
            (upright @ lin.C[:, self._z_axis], upright[:-1] @ lin.D[:, self._z_axis]),
            (normal[None, None] @ lin.C[:, self._x_axis], normal[None, None] @ lin.D[:, self._x_axis]),
            (force[..., None] * lin.C[:, self._force], force[:-1, :, None] * lin.D[:, self._force]),
        ]
        from_state = self._state_rows(xs, columns)
        jx = np.concatenate([*(jx for jx, _ in from_outputs), from_state], axis=1)
        still = np.zeros((len(xs) - 1, from_state.shape[1], lin.D.shape[2]))
        ju = np.concatenate([*(ju for _, ju in from_outputs), still], axis=1)
        return jx, ju

    def spread(self, weights: Weights, obstacle_scale: float) -> Array:
        """The weights as one vector `(R,)`; `obstacle_scale` is the decay of Eq. 3."""
        return np.array([
            *weights.position, *(2 * [weights.upright]), weights.yaw, *(3 * [weights.force]),
            *(7 * [weights.joint_limit]), *weights.joint_velocity,
            *(len(self._obstacles) * [weights.obstacle * obstacle_scale]),
        ])  # fmt: skip

    def _upright(self, z_axis: Array) -> tuple[Array, Array]:
        """Upright residual `(..., 2)` and its derivative by the axis `(..., 2, 3)`."""
        shape = z_axis.shape[:-1]
        if not self._uses_angle:
            return z_axis[..., :2] - self._target.axis, np.broadcast_to(np.eye(2, 3), (*shape, 2, 3))
        cosine = np.clip(z_axis[..., 2], -1.0 + 1e-9, 1.0 - 1e-9)
        residual = np.stack([np.arccos(cosine), np.zeros(shape)], axis=-1)
        slope = np.zeros((*shape, 2, 3))
        slope[..., 0, 2] = -1.0 / np.sqrt(1.0 - cosine**2)
        return residual, slope

    def _heading_normal(self) -> Array:
        """Horizontal normal of the wanted heading: its product with the x axis is sin(yaw error)."""
        return np.array([-np.sin(self._target.yaw), np.cos(self._target.yaw), 0.0])

    def _soft_force(self, force: Array) -> tuple[Array, Array]:
        """External force beyond the dead band `(..., 3)` [N] and its slope by the sensor's value."""
        external = self._weight - force
        excess = np.maximum(np.abs(external) - self._dead_band, 0.0)
        return np.sign(external) * excess, -(excess > 0.0).astype(float)

    def _offset(self, xs: Array, name: str) -> tuple[Array, Array]:
        """Horizontal offset of an obstacle from the target, and its length."""
        offset = xs[..., self._plant.layout.object_p[name][:2]] - self._target.p_WN[:2]
        return offset, np.maximum(np.linalg.norm(offset, axis=-1), DISTANCE_MIN)

    def _state_rows(self, xs: Array, columns: np.ndarray) -> Array:
        layout, where = self._plant.layout, {int(c): i for i, c in enumerate(columns)}
        rows = np.zeros((len(xs), 14 + len(self._obstacles), len(columns)))
        for j in range(7):
            rows[:, j, where[int(layout.q[j])]] = np.sinh(xs[:, layout.q[j]] - MIDDLE[j])
            rows[:, 7 + j, where[int(layout.v[j])]] = 1.0
        for i, name in enumerate(self._obstacles):
            p = layout.object_p[name]
            if int(p[0]) in where:
                offset, distance = self._offset(xs, name)
                slope = -np.exp(-distance)[:, None] * offset / distance[:, None]
                rows[:, 14 + i, [where[int(p[0])], where[int(p[1])]]] = slope
        return rows
