"""Poses of all objects: fitted to their markers where they are seen, predicted by physics where not.

After Russell, Xu, Roa, Dogar, "Pack it in" (section III-B): simulated physics moves the objects as the
measured arm pushes them, and what the cameras measure corrects it. Two markers alone do not determine a pose.
Together with the direction of the object's z axis they do: as predicted, or upright before the first fit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numba
import numpy as np
from pydantic import Field, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import DepthFrame
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.model import HeldRole, held_pose
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState, Source
from pack_perception.mocap.grip_tracker import GripConfig, GripTracker
from pack_perception.mocap.guided_cell import GuidedCell, PoseHistory, Rows
from pack_perception.mocap.pose_rows import pose_errors, shifted
from pack_perception.mocap.rigid_body_fit import FitConfig, FitRefusal, Mask
from pack_perception.mocap.sighting import AxisFitConfig, MarkerTable, sight


class CorrectionConfig(Config):
    """Gains of the correction; low ones suffice, because physics predicts well."""

    pose_gain: float = Field(default=0.1, gt=0, le=1, description="share of an error corrected each frame")
    twist_gain: float = Field(default=0.01, ge=0, le=1, description="share of it put down to velocity")
    jump: PositiveFloat = Field(default=0.03, description="error beyond which an object is put anew [m]")
    max_period: PositiveFloat = Field(default=0.03, description="between sights that tell a velocity [s]")


def is_put_anew(errors: Array, periods: Array, config: CorrectionConfig) -> Mask:
    """Which of k objects `(k,)` are set to the measured pose: when first measured, and after a jump."""
    return _is_put_anew(errors, periods, config.jump)


def corrections(errors: Array, periods: Array, config: CorrectionConfig) -> tuple[Array, Array]:
    """Changes of pose and of twist `(k, 6)` that correct k objects.

    Args:
        errors: `(k, 6)`, from `pose_errors`.
        periods: time since each was last measured `(k,)` [s]; infinite the first time.
        config: the gains.
    """
    anew = is_put_anew(errors, periods, config)
    return _corrections(errors, periods, anew, config.pose_gain, config.twist_gain, config.max_period)


@numba.njit("b1[::1](f8[:, :], f8[:], f8)", cache=True)
def _is_put_anew(errors: Array, periods: Array, jump: float) -> Mask:
    anew = np.empty(len(errors), dtype=np.bool_)
    for i in range(len(errors)):
        x, y, z = errors[i, 0], errors[i, 1], errors[i, 2]
        anew[i] = math.isinf(periods[i]) or math.sqrt(x * x + y * y + z * z) > jump
    return anew


@numba.njit("UniTuple(f8[:, ::1], 2)(f8[:, :], f8[:], b1[:], f8, f8, f8)", cache=True)
def _corrections(
    errors: Array, periods: Array, anew: Mask, pose_gain: float, twist_gain: float, max_period: float
) -> tuple[Array, Array]:
    shifts, twists = np.empty((len(errors), 6)), np.zeros((len(errors), 6))
    for i in range(len(errors)):
        # an error that grew over a long gap says little about the velocity now
        tells_velocity = not anew[i] and 0.0 < periods[i] <= max_period
        for j in range(6):
            shifts[i, j] = errors[i, j] if anew[i] else pose_gain * errors[i, j]
            # an error that arises within one period is one of velocity, error / period; a share is corrected
            if tells_velocity:
                twists[i, j] = twist_gain / periods[i] * errors[i, j]
    return shifts, twists


class EstimatorConfig(Config):
    """Parameters of the physics estimator and of its parts."""

    step: float = Field(default=0.004, gt=0, le=0.008, description="longest step of the physics [s]")
    max_gap: PositiveFloat = Field(
        default=0.5, description="longest gap between joint samples; after a longer one it starts over [s]"
    )
    mocap_age: PositiveFloat = Field(
        default=0.03, description="age of a fit without physics up to which a pose counts as MOCAP [s]"
    )
    history: PositiveInt = Field(
        default=50, description="steps of physics by which a marker frame may be late"
    )
    teleport: PositiveFloat = Field(
        default=3.0,
        description="an arm this many times faster than its velocity limits was put elsewhere, as by a reset",
    )
    correction: CorrectionConfig = CorrectionConfig()
    fit: FitConfig = FitConfig()
    axis_fit: AxisFitConfig = AxisFitConfig()
    grip: GripConfig = GripConfig()


@dataclass(frozen=True)
class Advance:
    """What happened while physics advanced to a joint sample.

    Attributes:
        is_restart: whether the estimate was reset, because time or the arm jumped.
        diverged: objects whose simulated motion diverged and that were put back to their last pose.
    """

    is_restart: bool = False
    diverged: tuple[str, ...] = ()


@dataclass(frozen=True)
class Correction:
    """What a marker frame changed.

    Attributes:
        seen: objects whose pose was corrected.
        partly: those of them whose markers alone were too few for a pose, so that physics helped.
        refused: objects whose markers could not be used, and why.
        mismatched: objects some of whose markers were left out, as they do not match the others.
        is_unused: whether the frame changed nothing, being older than the history or ahead of the joints.
    """

    seen: tuple[str, ...] = ()
    partly: tuple[str, ...] = ()
    refused: dict[str, FitRefusal] = field(default_factory=dict)
    mismatched: tuple[str, ...] = ()
    is_unused: bool = False


class PhysicsEstimator:
    """Poses and twists of all objects from joint samples and marker frames.

    Args:
        scene: shapes and masses; poses are ignored.
        cell: the cell's physical facts.
        config: gains and limits.
    """

    def __init__(self, scene: Scene, cell: PackingCell, config: EstimatorConfig) -> None:
        self._scene, self._cell, self._config = scene, cell, config
        self._markers = MarkerTable(scene)
        self._joints: JointSample | None = None
        self._start_over()

    @property
    def scene(self) -> Scene:
        """The scene as it is known: as described or, of unknown objects, as a look has found it."""
        return self._scene

    @property
    def time(self) -> float:
        """Time of the estimate [s]; nan before the first joint sample."""
        return self._joints.time if self._joints else float("nan")

    @property
    def is_held(self) -> bool:
        """Whether the new object is estimated to hang on the cup."""
        return self._grip.is_held

    def wants(self, time: float) -> bool:
        """Whether `advance` would use a joint sample of `time` [s]; it skips those less than a step later."""
        # written so that nan, the time before the first sample, gives True; 1e-6 s is for rounded stamps
        return not 0.0 <= time - self.time < self._config.step - 1e-6

    def is_ahead(self, frame: MarkerFrame | DepthFrame) -> bool:
        """Whether a frame has to wait for joint samples up to about its exposure."""
        return not frame.time <= self.time + 2 * self._config.step

    def advance(self, joints: JointSample) -> Advance:
        """Simulate the objects up to the time of a joint sample."""
        last = self._joints
        if last is None or self._jumps(last, joints):
            self._start_over()
            self._started = joints.time
            self._note(joints)
            return Advance(is_restart=last is not None)
        if not self.wants(joints.time):
            return Advance()
        diverged = self._physics.follow(last, joints)
        self._note(joints)
        return Advance(diverged=tuple(diverged))

    def correct(self, frame: MarkerFrame) -> Correction:
        """Correct the objects whose markers a frame shows.

        The errors are those at the time of exposure; they are corrected then and in all poses since.

        Raises:
            MessageError: the frame has an object or a marker that the scene does not have.
        """
        names, (p_WM, visible) = self._markers.names, self._markers.sort(frame)
        if self.is_ahead(frame) or not self._history.covers(frame.time):
            return Correction(is_unused=True)
        earlier, config = self._history.at(frame.time), self._config
        expected = self._physics.poses(earlier)
        is_known = self._is_known[: len(expected)]
        seen = sight(self._markers.p_BM, p_WM, visible, expected, is_known, config.fit, config.axis_fit)
        rows = np.flatnonzero(seen.is_placed)
        self._take(rows, seen.poses, earlier, frame.time)
        self._fitted[seen.is_placed & ~seen.is_partial] = frame.time
        refused = {names[i]: r for i, r in enumerate(seen.refusals) if r and visible[i].any()}
        partly = tuple(names[i] for i in np.flatnonzero(seen.is_partial))
        mismatched = tuple(names[i] for i in np.flatnonzero(seen.left_out))
        return Correction(tuple(names[i] for i in rows), partly, refused, mismatched)

    def state(self, time: float) -> SceneState:
        """Poses and twists of the held object and all others that have been seen, extrapolated to `time` [s].

        Objects that were never seen are left out. A pose is of source MOCAP if its markers alone gave it. A
        pose from two markers and a predicted axis is of source PHYSICS.
        """
        poses, twists = self._estimates()
        ahead = float(np.clip(time - self.time, 0.0, self._config.step))
        if ahead > 0.0:
            poses = shifted(poses, ahead * twists)
        ages = np.maximum(time - np.where(self._is_known, self._seen, self._started), 0.0)
        is_mocap = np.maximum(time - self._fitted, 0.0) <= self._config.mocap_age
        objects = {
            name: ObjectState(
                Pose(poses[i, :3], poses[i, 3:]), twists[i, :3], twists[i, 3:],
                Source.MOCAP if is_mocap[i] else Source.PHYSICS, float(ages[i]),
            )
            for i, name in enumerate(self._markers.names)
            if self._is_known[i] or i == self._held
        }  # fmt: skip
        return SceneState(time, objects)

    @property
    def _is_known(self) -> Mask:
        return np.asarray(np.isfinite(self._seen))

    @property
    def _held(self) -> int:
        """Row of the object that the model fixes to the cup: the last one, or -1 when it is free."""
        n = len(self._markers.names)
        return n - 1 if len(self._physics.free) < n else -1

    def _start_over(self) -> None:
        self._seen, self._fitted = np.full((2, len(self._markers.names)), -np.inf)
        self._started = 0.0
        is_held = not self._scene.is_handed_over
        self._grip = GripTracker(self._config.grip, held_pose(self._scene), is_held=is_held)
        role = HeldRole.RIGID if is_held else HeldRole.FREE
        self._use(GuidedCell(self._scene, self._cell, role, self._config.step))

    def _use(self, physics: GuidedCell) -> None:
        self._physics = physics
        self._history = PoseHistory(self._config.history, len(physics.qpos))

    def _note(self, joints: JointSample) -> None:
        self._joints = joints
        self._physics.set_arm(joints)
        self._history.add(joints.time, self._physics.qpos)

    def _jumps(self, last: JointSample, joints: JointSample) -> bool:
        gap = joints.time - last.time
        reach = self._config.teleport * self._cell.robot.arm.limits.velocity * max(gap, 1e-3)
        return bool(gap < 0.0 or gap > self._config.max_gap or np.any(np.abs(joints.q - last.q) > reach))

    def _estimates(self) -> tuple[Array, Array]:
        """Poses `(n, 7)` and twists `(n, 6)` of all objects."""
        poses, twists = self._physics.poses(), self._physics.twists()
        if self._held < 0:
            return poses, twists
        pose, twist = self._physics.held_state()
        return np.vstack([poses, pose]), np.vstack([twists, twist])

    def _take(self, rows: Rows, seen: Array, earlier: Array, time: float) -> None:
        """Correct some rows by the poses `seen` `(n, 7)` at `time`, when physics predicted `earlier`."""
        free = rows[rows != self._held]
        self._correct_free(free, seen[free], self._physics.poses(earlier)[free], time)
        self._seen[rows] = time
        if self._held in rows:
            p, q = np.split(seen[self._held], [3])
            self._grip.correct(self._physics.cup_pose(earlier).inverse() @ Pose(p, q), time)
            self._physics.set_grip(self._grip.X_TN)
            if not self.is_held:
                self._let_go()

    def _correct_free(self, rows: Rows, seen: Array, expected: Array, time: float) -> None:
        errors, periods = pose_errors(seen, expected), time - self._seen[rows]
        shifts, twists = corrections(errors, periods, self._config.correction)
        anew = is_put_anew(errors, periods, self._config.correction)
        if anew.any():
            self._physics.stop(rows[anew])
        self._physics.correct(rows, shifted(self._physics.poses()[rows], shifts), twists)
        self._physics.shift_earlier(self._history.since(time), rows, shifts)

    def _let_go(self) -> None:
        """Continue with a model in which the new object is free; the next frame corrects its pose."""
        assert self._joints is not None
        poses, twists = self._estimates()
        self._use(GuidedCell(self._scene, self._cell, HeldRole.FREE, self._config.step))
        known = np.flatnonzero(self._is_known)
        self._physics.correct(known, poses[known], twists[known])
        self._note(self._joints)
