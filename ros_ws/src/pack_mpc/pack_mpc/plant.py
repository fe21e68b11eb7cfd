"""The controller's model of the cell: batched rollouts and finite differences on reduced states."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from itertools import chain

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from pack_core.bodies import body_pose
from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell, Tip
from pack_core.packing.model import (
    TIP_JOINTS,
    ArmRole,
    HeldRole,
    build_model,
    cup_point,
    held_pose,
    tip_coordinates,
)
from pack_core.packing.rollouts import SleepingRollouts
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, conjugate, multiply
from pack_core.states import SceneState

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
EPSILON = 1e-6
"""Step of the finite differences, in each component's unit: larger steps straddle contacts that switch on."""
_TURNS = np.hstack([np.ones((3, 1)), 0.5 * EPSILON * np.eye(3)])
"""Quaternions of rotations by `EPSILON` [rad] about x, y and z."""


@dataclass(frozen=True)
class Layout:
    """Indices into a full state `[time, qpos, qvel]`.

    Attributes:
        q: positions of the arm's joints `(7,)`.
        v: velocities of the arm's joints `(7,)`.
        object_p: position `(3,)` of each object by its name.
        object_r: vector part `(3,)` of each object's quaternion wxyz by its name.
        object_v: linear velocity `(3,)` of each object by its name.
        object_w: angular velocity `(3,)` of each object by its name.
    """

    q: np.ndarray
    v: np.ndarray
    object_p: dict[str, np.ndarray]
    object_r: dict[str, np.ndarray]
    object_v: dict[str, np.ndarray]
    object_w: dict[str, np.ndarray]


@dataclass(frozen=True)
class Linearization:
    """First-order model along a trajectory: dx_{t+1} = A dx_t + B du_t, dy_t = C dx_t + D du_t.

    `A (T,n,n)`, `B (T,n,m)`, `C (T+1,p,n)`, `D (T,p,m)` for n states, m controls and p outputs.
    """

    A: Array
    B: Array
    C: Array
    D: Array


class PackingPlant:
    """x_{t+1} = f(x_t, u_t) with u the controls of a gravity-compensated arm.

    Args:
        scene: shapes, sizes and masses; poses come with each state.
        cell: the cell's physical facts. With a `tip` the object hangs on its springs, without one it is
            fixed to the cup.
        timestep: time step of the model [s].
        threads: number of threads for rollouts.
        arm: whether u is torques `(7,)`, or positions and velocities `(14,)` for the driver's servos.

    Attributes:
        scene: the scene with the objects that are in the model; `include` changes which.
        arm: the cell's arm.
        bent: limits of its joints within which the elbow stays bent, see `ArmDrive.bent`.
        watch: called with states and outputs of every batch of rollouts.
    """

    def __init__(
        self, scene: Scene, cell: PackingCell, *, timestep: float, threads: int, arm: ArmRole = ArmRole.DRIVEN
    ) -> None:
        self.arm, self.bent = cell.robot.arm, cell.robot.bent
        self.timestep = timestep
        self.watch: Callable[[Array, Array], None] = lambda xs, ys: None
        self._whole, self._threads = scene, threads
        self._compile: Callable[[Scene], mujoco.MjModel] = lambda part: _compiled(part, cell, timestep, arm)
        self._is_compliant = cell.tip is not None
        self._rollout = Rollout(nthread=threads)
        self._model_of(scene)
        self.nu = int(self.model.nu)
        self._whole_layout, self._kept = self.layout, np.arange(self.nx)
        self.limits = self.model.actuator_ctrlrange[:, 1].copy()

    def include(self, names: Collection[str]) -> None:
        """Have these objects alone in the model; of the others it knows nothing from now on.

        Their order does not matter: objects follow one another as in the scene of the plant.
        """
        objects = [item for item in self._whole.objects if item.name in names]
        if [item.name for item in objects] == self.scene.names:
            return
        self._model_of(self._whole.model_copy(update={"objects": objects}))
        at, left_out = self._whole_layout, set(self._whole.names) - set(self.scene.names)
        # Three of position and four of the quaternion follow one another, and three and three of velocity.
        out = [
            np.r_[at.object_p[name][0] + np.arange(7), at.object_v[name][0] + np.arange(6)]
            for name in left_out
        ]
        count = self.nx + sum(map(len, out))
        self._kept = np.delete(np.arange(count), np.concatenate([np.zeros(0, dtype=int), *out]))

    def part(self, x: Array) -> Array:
        """The state `(nx,)` of this model's objects, of a state with all objects of the scene."""
        return np.asarray(x[self._kept])

    def _model_of(self, scene: Scene) -> None:
        """Compile the model of a scene, which takes a few milliseconds, and whatever depends on it."""
        self.scene, self.model = scene, self._compile(scene)
        self._datas = [mujoco.MjData(self.model) for _ in range(self._threads)]
        self._sleeping = SleepingRollouts(self.model, self._threads)
        self.nx = mujoco.mj_stateSize(self.model, STATE)
        self.layout = self._find_layout()
        # Place in its quaternion, 1 to 3, of each component of a vector part.
        self._axes = {
            int(c): i for part in self.layout.object_r.values() for i, c in enumerate(part, start=1)
        }
        tip = TIP_JOINTS if self._is_compliant else ()
        self._tip = np.array([1 + self.model.joint(name).qposadr[0] for name in tip], dtype=int)

    def sensor(self, name: str) -> slice:
        """Indices of a sensor's values in the output y."""
        sensor = self.model.sensor(name)
        return slice(int(sensor.adr[0]), int(sensor.adr[0] + sensor.dim[0]))

    def state(self, joints: JointSample, scene: SceneState) -> Array:
        """Full state `(nx,)` from measured joints and estimated objects.

        Raises:
            KeyError: the estimate lacks an object.
        """
        data = self._datas[0]
        mujoco.mj_resetData(self.model, data)
        x = np.empty(self.nx)
        mujoco.mj_getState(self.model, data, x, STATE)
        x[0] = joints.time
        x[self.layout.q], x[self.layout.v] = joints.q, joints.v
        for name in self.scene.names:
            item = scene.objects[name]
            p, v = self.layout.object_p[name], self.layout.object_v[name]
            # Three of position and four of the quaternion follow one another in qpos.
            x[p[0] : p[0] + 7] = [*item.X_WO.p, *item.X_WO.q]
            x[v] = item.v_WO_W
        if self._is_compliant:
            x[self._tip] = self._bent(joints.q, scene.objects[self.scene.new_object.name].X_WO)
        return x

    def _bent(self, q: Array, X_WN: Pose) -> Array:
        """Coordinates `(6,)` [m, rad] of the tip with which the object is at X_WN, the joints at `q`."""
        data = self._datas[0]
        data.qpos[self.layout.q - 1] = q
        mujoco.mj_kinematics(self.model, data)
        X_TN = body_pose(data, "tool").inverse() @ X_WN
        return tip_coordinates(held_pose(self.scene), X_TN, cup_point(self.scene))

    def held_position(self, x: Array) -> Array:
        """Position `(3,)` [m] of the held object in a state `(nx,)`."""
        data = self._datas[0]
        mujoco.mj_setState(self.model, data, x, STATE)
        mujoco.mj_kinematics(self.model, data)
        return np.array(data.body(self.scene.new_object.name).xpos)

    def held_jacobian(self, q: Array) -> Array:
        """Jacobian `(6, 7)` of the held object in the world, linear part first, the joints at `q` `(7,)`."""
        data, J = self._datas[0], np.empty((6, self.model.nv))
        mujoco.mj_resetData(self.model, data)
        data.qpos[self.layout.q - 1] = q
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        mujoco.mj_jacBody(self.model, data, J[:3], J[3:], self.model.body(self.scene.new_object.name).id)
        return J[:, self.layout.v - 1 - self.model.nq]

    def rollout(self, x0: Array, us: Array) -> tuple[Array, Array]:
        """Simulate a batch of control sequences from one state.

        Args:
            x0: `(nx,)`.
            us: `(B, T, nu)`.

        Returns:
            States `(B, T + 1, nx)` and sensor outputs `(B, T + 1, ny)`; the last output is taken
            with the last controls held.
        """
        batch, steps, _ = us.shape
        controls = np.concatenate([us, us[:, -1:]], axis=1)
        x0s = np.broadcast_to(x0, (batch, self.nx))
        states, ys = self._sleeping.run(x0s, controls)
        xs = np.concatenate([x0s[:, None], states[:, :steps]], axis=1)
        self.watch(xs, ys)
        return xs, ys

    def linearize(self, xs: Array, us: Array, columns: np.ndarray, keypoints: np.ndarray) -> Linearization:
        """Forward differences at the key-points, interpolated between them.

        Args:
            xs: `(T + 1, nx)`.
            us: `(T, nu)`.
            columns: indices of the n state components that take part. The vector part of a quaternion stands
                for a small rotation [rad] about the object's own axes, as components of a quaternion do not
                vary one by one.
            keypoints: step indices in rising order, the first 0 and the last T.
        """
        n, m, k = len(columns), self.nu, len(keypoints)
        # A key-point takes this many simulated steps: one as it is, one a state component, one a control.
        width = 1 + n + m
        u = np.concatenate([us, us[-1:]])[keypoints]
        states = np.repeat(xs[keypoints], width, axis=0).reshape(k, width, -1)
        controls = np.repeat(u, width, axis=0).reshape(k, width, m)
        for i, column in enumerate(columns):
            if (axis := self._axes.get(int(column))) is None:
                states[:, 1 + i, column] += EPSILON
            else:
                q, first = states[:, 1 + i], int(column) - axis
                q[:, first : first + 4] = multiply(q[:, first : first + 4], _TURNS[axis - 1])
        controls[:, np.arange(n + 1, width), np.arange(m)] += EPSILON
        nexts, ys = self._rollout.rollout(
            self.model, self._datas, states.reshape(k * width, -1), controls.reshape(k * width, 1, m)
        )
        changes = self._changes(nexts.reshape(k, width, -1), columns)
        ys = ys.reshape(k, width, -1)
        fx = changes[:, 1:].swapaxes(1, 2) / EPSILON
        yx = (ys[:, 1:] - ys[:, :1]).swapaxes(1, 2) / EPSILON
        f, y = (_interpolate(values, keypoints, len(xs)) for values in (fx, yx))
        return Linearization(A=f[:-1, :, :n], B=f[:-1, :, n:], C=y[:, :, :n], D=y[:-1, :, n:])

    def columns(self, objects: list[str], *, turning: bool = False) -> np.ndarray:
        """Indices of the reduced state: the arm's q and v, and position and velocity of the given objects.

        Objects that nothing touches, and how objects turn unless `turning`, are left out: each component
        costs a simulated step at every key-point.
        """
        at = self.layout
        poses = [[at.object_p[name], *([at.object_r[name]] if turning else [])] for name in objects]
        twists = [[at.object_v[name], *([at.object_w[name]] if turning else [])] for name in objects]
        return np.concatenate([at.q, *chain(*poses), at.v, *chain(*twists)])

    def _changes(self, states: Array, columns: np.ndarray) -> Array:
        """What differs in states `(k, w, nx)` from the first of each key-point, by columns `(k, w, n)`."""
        changes = (states - states[:, :1])[:, :, columns]
        for i, column in enumerate(columns):
            if (axis := self._axes.get(int(column))) is not None:
                q = states[..., int(column) - axis :][..., :4]
                # twice the vector part of q0^-1 q is the small rotation from q0 to q, about its own axes
                changes[..., i] = 2.0 * multiply(conjugate(q[:, :1]), q)[..., axis]
        return changes

    def _find_layout(self) -> Layout:
        model, nq = self.model, self.model.nq
        joints = {name: model.joint(name) for name in (*self.arm.joints, *self.scene.names)}
        own = {
            name: (1 + joints[name].qposadr[0], 1 + nq + joints[name].dofadr[0]) for name in self.scene.names
        }
        return Layout(
            q=np.array([1 + joints[name].qposadr[0] for name in self.arm.joints]),
            v=np.array([1 + nq + joints[name].dofadr[0] for name in self.arm.joints]),
            object_p={name: q + np.arange(3) for name, (q, _) in own.items()},
            object_r={name: q + np.arange(4, 7) for name, (q, _) in own.items()},
            object_v={name: v + np.arange(3) for name, (_, v) in own.items()},
            object_w={name: v + np.arange(3, 6) for name, (_, v) in own.items()},
        )


def _compiled(scene: Scene, cell: PackingCell, timestep: float, arm: ArmRole) -> mujoco.MjModel:
    """The model; what hangs on a tip has no weight in it, as the driver of the arm compensates it."""
    if cell.tip is None:
        return build_model(scene, cell, timestep=timestep, arm=arm, held=HeldRole.RIGID)
    steady = cell.model_copy(update={"tip": _steady(cell.tip, timestep)})
    model = build_model(scene, steady, timestep=timestep, arm=arm, held=HeldRole.COMPLIANT)
    model.body_gravcomp[model.body(scene.new_object.name).id] = 1.0
    return model


def _steady(tip: Tip, timestep: float) -> Tip:
    """The same stiffness, damped so that any mass is stable at this step.

    The integrator has damping c = T k implicitly and stiffness k explicitly: with a mass m it is stable for
    k h^2 <= 4 m + 2 T k h, which holds for every m if T is at least half of the step h.
    """
    return tip.model_copy(update={"damping_time": max(tip.damping_time, 0.5 * timestep)})


def _interpolate(values: Array, keypoints: np.ndarray, length: int) -> Array:
    """Linear interpolation of `(k, ...)` at `keypoints` to `(length, ...)`."""
    steps = np.arange(length)
    i = np.clip(np.searchsorted(keypoints, steps, side="right") - 1, 0, len(keypoints) - 2)
    s = (steps - keypoints[i]) / (keypoints[i + 1] - keypoints[i])
    s = s.reshape(-1, *([1] * (values.ndim - 1)))
    return np.asarray((1 - s) * values[i] + s * values[i + 1])
