"""What the controller's model predicts of a run, to compare with what happened (Eqs. 7 and 8).

The paper measures "actual versus simulated" poses: the model that the MPC plans with against the world. It is
read here as follows. The model has the sizes, masses and frictions that the nodes are told, and holds the new
object rigidly at the pump tip. Every 0.6 s, the paper's horizon, it starts from the poses that the controller
knew, with all objects at rest. Until the next start its arm follows the joints as they were measured, and its
objects move by its physics alone. With planned joints instead, a plan that was given up half way would count
as an error of the model. What remains is what the model has wrong, beside the error of the poses it starts
from.
"""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from pack_core.bodies import body_pose, set_object_poses
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import ArmRole, HeldRole, build_model, parked_pose
from pack_core.rotations import Array
from pack_core.states import Source
from pack_evaluation.packing.run import Run
from pack_evaluation.track import Track

HORIZON = 0.6
"""Length of a prediction [s], the optimization horizon T of section IV-B."""
STEP = 0.006
"""Longest step of the integrator [s], the paper's model time step (section IV-B)."""
MAX_SPEED = 3.0
"""An object faster than this moves only because the physics diverged [m/s]."""


def predict(run: Run) -> dict[str, Track]:
    """Poses that the model predicts during the goal, at the times of the true poses.

    Returns:
        Tracks of the objects in the container that have an estimate, and of the held object. The held object
        hangs rigidly on the arm as measured, so its track needs no physics.
    """
    times = run.truth[run.held].between(run.start, run.end).times
    if not times.size:
        return {}
    model = _GuidedModel(run)
    poses = np.empty((times.size, len(model.names), 7))
    start = -np.inf
    for i, time in enumerate(times):
        # 1e-6 s is for rounded stamps
        if time - start < HORIZON - 1e-6 and model.advance(times[i - 1], time):
            poses[i] = model.poses()
        else:
            start = time
            poses[i] = model.restart(time)
    tracks = {name: _track(times, poses[:, k]) for k, name in enumerate(model.names)}
    return {**tracks, run.held: _track(times, model.held(times))}


class _GuidedModel:
    """The controller's model with its arm on the measured joints of a run.

    Attributes:
        names: objects in the container that the model can be started with.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        cell = packing_cell().with_arm(run.arm)
        self._model = build_model(run.scene, cell, timestep=STEP, arm=ArmRole.GUIDED, held=HeldRole.RIGID)
        # a diverged simulation is started anew here, not at MuJoCo's initial state
        self._model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._data = mujoco.MjData(self._model)
        joints = [self._model.joint(name) for name in cell.robot.arm.joints]
        self._arm_q = np.array([joint.qposadr[0] for joint in joints])
        self._arm_v = np.array([joint.dofadr[0] for joint in joints])
        self.names = [name for name in run.scene.names if name in run.estimate]
        free = [self._model.joint(name) for name in self.names]
        # a free joint: position and quaternion in qpos, linear and angular velocity in qvel
        self._q = np.array([joint.qposadr[0] for joint in free], dtype=int)[:, None] + np.arange(7)
        self._v = np.array([joint.dofadr[0] for joint in free], dtype=int)[:, None] + np.arange(6)
        # objects without any estimate stand out of reach of everything else
        unseen = [name for name in run.scene.names if name not in self.names]
        parked = {name: parked_pose(i, run.scene.model_of(name)) for i, name in enumerate(unseen)}
        set_object_poses(self._model, self._data, parked)

    def restart(self, time: float) -> Array:
        """Put every object where perception saw it at `time` [s], at rest, and return the poses `(n, 7)`."""
        now = np.array([time])
        poses = {name: self._run.estimate[name].at(now).pose(0) for name in self.names}
        set_object_poses(self._model, self._data, poses)
        # the solver would start from the accelerations of the run before
        self._data.qacc_warmstart[:] = 0.0
        return self.poses()

    def advance(self, start: float, end: float) -> bool:
        """Simulate from `start` to `end` [s]; False if the physics diverged."""
        data, gap = self._data, end - start
        steps = max(1, int(np.ceil(gap / STEP - 1e-6)))
        self._model.opt.timestep = gap / steps
        q = self._joints(np.linspace(start, end, steps + 1))
        for i in range(steps):
            data.qpos[self._arm_q] = q[i]
            data.qvel[self._arm_v] = (q[i + 1] - q[i]) * steps / gap
            mujoco.mj_step(self._model, data)
        speeds = data.qvel[self._v[:, :3]]
        # written so that nan, too, is a divergence
        return bool(np.all(np.abs(speeds) < MAX_SPEED))

    def poses(self) -> Array:
        """X_WO of the objects `(n, 7)`: position and quaternion wxyz."""
        return np.array(self._data.qpos[self._q])

    def held(self, times: Array) -> Array:
        """X_WN of the held object on the measured arm, `(T, 7)`, by forward kinematics."""
        data, poses = mujoco.MjData(self._model), np.empty((times.size, 7))
        for i, q in enumerate(self._joints(times)):
            data.qpos[self._arm_q] = q
            mujoco.mj_kinematics(self._model, data)
            X_WN = body_pose(data, self._run.held)
            poses[i] = [*X_WN.p, *X_WN.q]
        return poses

    def _joints(self, times: Array) -> Array:
        """Measured joint positions `(T, 7)` [rad], linear between samples."""
        return np.column_stack([np.interp(times, self._run.joint_times, q) for q in self._run.joints.T])


def _track(times: Array, poses: Array) -> Track:
    sources = np.full(times.size, Source.PHYSICS, dtype=np.uint8)
    return Track(times, poses[:, :3], poses[:, 3:], sources)


def position_errors(run: Run, tracks: Mapping[str, Track]) -> Array:
    """Distances [m] from true positions during the goal, of all objects in the container in one array.

    Their mean is M_pos (Eq. 7) where the tracks are those of the controller's model. Objects without a track,
    which no camera has seen, are left out.
    """
    windows = [(name, _window(run, tracks[name])) for name in run.scene.names if name in tracks]
    errors = [track.distance_to(run.truth[name].at(track.times).p) for name, track in windows]
    return np.concatenate(errors) if errors else np.empty(0)


def held_position_errors(run: Run, tracks: Mapping[str, Track]) -> Array:
    """Distances `(T,)` [m] of the held object from its true positions during the goal."""
    if run.held not in tracks:
        return np.empty(0)
    track = _window(run, tracks[run.held])
    return track.distance_to(run.truth[run.held].at(track.times).p)


def held_rotation_errors(run: Run, tracks: Mapping[str, Track]) -> Array:
    """Angles `(T,)` [rad] of the held object from its true orientations during the goal.

    Their mean is M_rot (Eq. 8) where the tracks are those of the controller's model.
    """
    if run.held not in tracks:
        return np.empty(0)
    track = _window(run, tracks[run.held])
    return track.angle_to(run.truth[run.held].at(track.times))


def _window(run: Run, track: Track) -> Track:
    return track.between(run.start, run.end)
