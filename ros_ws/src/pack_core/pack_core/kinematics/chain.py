"""A serial arm: forward kinematics and its first two derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.errors import PackError
from pack_core.kinematics import screws
from pack_core.rotations import Array, Pose, from_matrix, rotate, to_matrix

Z = np.array([0.0, 0.0, 1.0])
"""A joint's axis in its own frame."""


@dataclass(frozen=True)
class SerialChain:
    """Revolute joints in a row that carry a tool T, all given where every joint is zero.

    Attributes:
        axes: unit joint axes `(n, 3)` in the world.
        points: a point of each axis `(n, 3)` [m].
        R_WT: the tool's orientation `(3, 3)`.
        p_WT: the tool's position `(3,)` [m].
    """

    axes: Array
    points: Array
    R_WT: Array
    p_WT: Array

    def __post_init__(self) -> None:
        if self.axes.shape != self.points.shape or self.axes.shape[1:] != (3,):
            raise PackError(f"axes {self.axes.shape} and points {self.points.shape}; allowed: both (n, 3)")
        for name in ("axes", "points", "R_WT", "p_WT"):
            array = np.ascontiguousarray(getattr(self, name), dtype=float)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @classmethod
    def from_joints(cls, X_WB: Pose, joints: Iterable[Pose], X_LT: Pose) -> SerialChain:
        """Joints that turn about z of their frames.

        Args:
            X_WB: the base.
            joints: each joint's frame in the one before, at angle 0.
            X_LT: the tool in the last joint's frame.
        """
        X_WJ, axes, points = X_WB, [], []
        for X_PJ in joints:
            X_WJ = X_WJ @ X_PJ
            axes.append(rotate(X_WJ.q, Z))
            points.append(X_WJ.p)
        X_WT = X_WJ @ X_LT
        return cls(np.array(axes), np.array(points), to_matrix(X_WT.q), X_WT.p)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.axes)

    def with_tool(self, X_TN: Pose) -> SerialChain:
        """The same arm with a tool frame N that is fixed in the present tool's frame."""
        R = self.R_WT @ to_matrix(X_TN.q)
        return SerialChain(self.axes, self.points, R, self.p_WT + self.R_WT @ X_TN.p)

    def links(self, q: Array) -> tuple[Array, Array]:
        """How every link has moved from where all joints are zero: `R (n, 3, 3)` and `d (n, 3)`.

        A point of link i that is at x where all joints are zero is at `R[i] @ x + d[i]`.
        """
        return screws.link_transforms(self.axes, self.points, np.asarray(q, dtype=float))

    def forward_matrix(self, q: Array) -> tuple[Array, Array]:
        """R_WT `(3, 3)` and p_WT `(3,)` [m] of the tool."""
        R, d = self.links(q)
        return R[-1] @ self.R_WT, R[-1] @ self.p_WT + d[-1]

    def forward(self, q: Array) -> Pose:
        """X_WT of the tool."""
        R, p = self.forward_matrix(q)
        return Pose(p, from_matrix(R))

    def jacobian(self, q: Array) -> Array:
        """Jacobian `(6, n)` of the tool in world axes: linear rows, then angular rows."""
        R, d = self.links(q)
        z, p = screws.world_axes(self.axes, self.points, R, d)
        return screws.jacobian(z, p, R[-1] @ self.p_WT + d[-1], self.n - 1)

    def bias(self, q: Array, v: Array) -> Array:
        """`Jdot v` `(6,)`: acceleration of the tool, linear then angular, while no joint accelerates."""
        R, d = self.links(q)
        z, p = screws.world_axes(self.axes, self.points, R, d)
        return screws.bias(z, p, np.asarray(v, dtype=float), R[-1] @ self.p_WT + d[-1], self.n - 1)

    def joint_rates(self, q: Array, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        """Joint velocities and accelerations `(T, n)` that move the tool of a six-joint chain so.

        Args:
            q: joint positions `(T, n)`.
            rates: of the tool `(T, 6)`, world axes: linear, then angular.
            accelerations: of the tool `(T, 6)`.
        """
        columns = (np.ascontiguousarray(column) for column in (q, rates, accelerations))
        v, a = screws.joint_rates(self.axes, self.points, self.p_WT, *columns)
        return v, a


def chain_from_model(model: mujoco.MjModel, joints: Sequence[str], tool: str) -> SerialChain:
    """The hinges named `joints`, from base to tip, and the body `tool` that the last one carries.

    Raises:
        PackError: a joint is no hinge, or does not carry the tool.
    """
    data = mujoco.MjData(model)
    # Other joints, such as fingers or gears, stay at their references; those of the chain go to zero, which
    # need not be their reference.
    data.qpos[:] = model.qpos0
    for name in joints:
        data.qpos[model.joint(name).qposadr[0]] = 0.0
    mujoco.mj_kinematics(model, data)
    carriers = _ancestors(model, model.body(tool).id)
    for name in joints:
        joint = model.joint(name)
        if joint.type[0] != mujoco.mjtJoint.mjJNT_HINGE or joint.bodyid[0] not in carriers:
            raise PackError(f"joint '{name}' must be a hinge that carries the body '{tool}'")
    index = [model.joint(name).id for name in joints]
    body = data.body(tool)
    return SerialChain(
        data.xaxis[index].copy(), data.xanchor[index].copy(), body.xmat.reshape(3, 3).copy(), body.xpos.copy()
    )


def _ancestors(model: mujoco.MjModel, body: int) -> set[int]:
    found = set()
    while body != 0:
        found.add(body)
        body = int(model.body_parentid[body])
    return found
