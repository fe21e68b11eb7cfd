"""Physics of the cell in which the arm follows its measured joint positions."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.bodies import body_pose
from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import ArmRole, HeldRole, build_model, parked_pose
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_perception.mocap.pose_rows import shift, turned

Rows = npt.NDArray[np.int_]

RELAXATION = 50
"""Steps in which objects that overlap are pushed apart; each takes about 4 % off the overlap."""
MAX_SPEED = 3.0
"""An object faster than this moves only because the physics diverged [m/s]."""


class GuidedCell:
    """Free objects move by physics, the arm by measured joints.

    Objects are addressed by their row in `free`. Poses, shifts and twists are rows as in `pose_rows`.

    Args:
        scene: container and objects; poses are ignored.
        cell: the cell's physical facts.
        held: whether the new object is fixed to the cup.
        step: longest step of the integrator [s].

    Attributes:
        free: names of the objects that physics moves.
    """

    def __init__(self, scene: Scene, cell: PackingCell, held: HeldRole, step: float) -> None:
        self._step = step
        self._model = build_model(scene, cell, timestep=step, arm=ArmRole.GUIDED, held=held)
        self._model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._data, self._posed = mujoco.MjData(self._model), mujoco.MjData(self._model)
        joints = cell.robot.arm.joints
        first = self._model.joint(joints[0])
        self._arm_q = slice(first.qposadr[0], first.qposadr[0] + len(joints))
        self._arm_v = slice(first.dofadr[0], first.dofadr[0] + len(joints))
        items = [*scene.objects] if held is HeldRole.RIGID else [*scene.objects, scene.new_object]
        self.free = [item.name for item in items]
        self._q = _addresses([self._model.joint(name).qposadr[0] for name in self.free], 7)
        self._v = _addresses([self._model.joint(name).dofadr[0] for name in self.free], 6)
        self._new_object = int(self._model.body(scene.new_object.name).id)
        for i, item in enumerate(items):
            X_WO = parked_pose(i, item)  # until it is measured
            self._data.qpos[self._q[i]] = [*X_WO.p, *X_WO.q]

    @property
    def qpos(self) -> Array:
        """A copy of all generalised positions, as MuJoCo orders them."""
        return np.array(self._data.qpos)

    def follow(self, start: JointSample, end: JointSample) -> list[str]:
        """Integrate while the arm moves evenly from one sample to the next.

        Returns:
            Objects whose motion diverged; they are back where they started, at rest.
        """
        data, before = self._data, self.qpos
        gap = end.time - start.time
        # equal steps that fill the gap; 1e-6 keeps rounding from adding one
        n = max(1, int(np.ceil(gap / self._step - 1e-6)))
        self._model.opt.timestep = gap / n
        way = end.q - start.q
        for i in range(n):
            data.qpos[self._arm_q] = start.q + way * (i / n)
            data.qvel[self._arm_v] = way / gap
            mujoco.mj_step(self._model, data)
        self.set_arm(end)
        return self._put_back(before)

    def set_arm(self, joints: JointSample) -> None:
        """Set the arm's positions and velocities to those of a sample."""
        self._data.qpos[self._arm_q], self._data.qvel[self._arm_v] = joints.q, joints.v

    def poses(self, qpos: Array | None = None) -> Array:
        """X_WO of the free objects `(n, 7)`, position and quaternion, now or in an earlier `qpos`."""
        return np.asarray((self._data.qpos if qpos is None else qpos)[self._q])

    def twists(self) -> Array:
        """Twists of the free objects `(n, 6)`."""
        # MuJoCo has a free joint's angular velocity in the body's axes
        return turned(self.poses(), self._data.qvel[self._v], is_inverse=False)

    def stop(self, rows: Rows) -> None:
        """Bring objects to rest."""
        self._data.qvel[self._v[rows]] = 0.0

    def pushed_apart(self, rows: Rows, poses: Array) -> Array:
        """Poses `(k, 7)` near `poses` at which objects overlap less, with each other and with all else.

        Contact forces move them, but they come to rest after each step: objects that were suddenly set into
        each other would fly apart, and round ones roll on.
        """
        data, self._model.opt.timestep = self._posed, self._step
        data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = self._data.qpos, 0.0, 0.0
        data.qpos[self._q[rows]] = poses
        for _ in range(RELAXATION):
            mujoco.mj_step(self._model, data)
            data.qpos[self._arm_q], data.qvel[:] = self._data.qpos[self._arm_q], 0.0
        apart = np.asarray(data.qpos[self._q[rows]])
        return np.where(np.isfinite(apart).all(axis=1, keepdims=True), apart, poses)

    def correct(self, rows: Rows, poses: Array, twists: Array) -> None:
        """Set slightly different poses `(k, 7)` of objects, and add `twists` `(k, 6)` to their twists."""
        self._data.qpos[self._q[rows]] = poses
        self._data.qvel[self._v[rows]] += turned(poses, twists, is_inverse=True)

    def shift_earlier(self, qpos: Array, rows: Rows, shifts: Array) -> None:
        """Apply `shifts` `(k, 6)` to objects in earlier positions `qpos` `(t, nq)`, in place."""
        shift(qpos, self._q[rows], shifts)

    def cup_pose(self, qpos: Array) -> Pose:
        """X_WT of the cup in an earlier `qpos`."""
        self._posed.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, self._posed)
        return body_pose(self._posed, "tool")

    def held_state(self) -> tuple[Array, Array]:
        """Pose `(7,)` and twist `(6,)` of the new object on the cup, by forward kinematics."""
        posed, body, twist = self._posed, self._new_object, np.empty(6)
        posed.qpos[:], posed.qvel[:] = self._data.qpos, self._data.qvel
        mujoco.mj_kinematics(self._model, posed)
        mujoco.mj_comPos(self._model, posed)
        mujoco.mj_comVel(self._model, posed)
        mujoco.mj_objectVelocity(self._model, posed, mujoco.mjtObj.mjOBJ_XBODY, body, twist, 0)
        # MuJoCo gives the angular part first
        return np.concatenate([posed.xpos[body], posed.xquat[body]]), np.roll(twist, 3)

    def set_grip(self, X_TN: Pose) -> None:
        """Change the pose X_TN in which the new object is fixed to the cup."""
        self._model.body_pos[self._new_object], self._model.body_quat[self._new_object] = X_TN.p, X_TN.q

    def _put_back(self, before: Array) -> list[str]:
        data = self._data
        speeds = np.abs(data.qvel[self._v[:, :3]])
        # The sum is finite only if all positions are; written so that nan speeds go on to the closer look.
        if speeds.max(initial=0.0) < MAX_SPEED and math.isfinite(data.qpos.sum()):
            return []
        speeds = speeds.max(axis=1, initial=0.0)
        is_fine = (speeds < MAX_SPEED) & np.isfinite(data.qpos[self._q]).all(axis=1)
        if is_fine.all():
            return []
        bad = np.flatnonzero(~is_fine)
        data.qpos[self._q[bad]], data.qvel[self._v[bad]] = before[self._q[bad]], 0.0
        # the solver would start from the diverged accelerations
        data.qacc_warmstart[:] = 0.0
        return [self.free[i] for i in bad]


def _addresses(starts: list[int], length: int) -> Rows:
    return np.array(starts, dtype=int)[:, None] + np.arange(length)


class PoseHistory:
    """The positions `qpos` at the last `length` times, for measurements that arrive late.

    Args:
        length: number of times that are kept.
        nq: size of `qpos`.
    """

    def __init__(self, length: int, nq: int) -> None:
        self._times = np.full(length, -np.inf)
        self._qpos = np.zeros((length, nq))

    def add(self, time: float, qpos: Array) -> None:
        """Append the positions at `time` [s], which is later than all times before."""
        self._times[:-1], self._qpos[:-1] = self._times[1:], self._qpos[1:]
        self._times[-1], self._qpos[-1] = time, qpos

    def covers(self, time: float) -> bool:
        """Whether the history reaches back to `time` [s]."""
        return bool(np.any(np.isfinite(self._times) & (self._times <= time)))

    def at(self, time: float) -> Array:
        """Positions `(nq,)` at a time that the history covers; the newest ones for later times.

        They are interpolated linearly between two entries, so quaternions have only nearly unit length.
        """
        i = int(np.searchsorted(self._times, time, side="right"))
        if i == len(self._times):
            return np.array(self._qpos[-1])
        t0, t1 = self._times[i - 1 : i + 1]
        s = (time - t0) / (t1 - t0)
        return np.asarray((1.0 - s) * self._qpos[i - 1] + s * self._qpos[i])

    def since(self, time: float) -> Array:
        """The entries `(t, nq)` after `time`, oldest first; writing to them changes the history."""
        return self._qpos[int(np.searchsorted(self._times, time, side="right")) :]
