"""`pack calibrate packing` in one process, without ROS, on simulated time.

The arm brings its empty pump to postures over the container, tilted at most of them, and stands still at
each until the depth cameras have taken some images. Where the cameras hang follows from these.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from pack_core.camera import PinholeCamera
from pack_core.errors import MessageError
from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import points_of
from pack_core.packing.depth_calibration import DepthCalibration, FoundCamera
from pack_core.packing.packing_list import handed_over
from pack_core.packing.scene import Scene
from pack_core.pose_config import PoseConfig
from pack_core.rotations import POINTING_DOWN, Array, Pose, exp, from_yaw, multiply
from pack_core.states import SceneState
from pack_core.tasks.steps import Steps, TaskRun
from pack_lockstep.packing.lockstep_config import LockstepConfig
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.requests import FillObservation, FillPort
from pack_perception.depth.camera_calibration import (
    ArmView,
    CameraCalibrationConfig,
    CameraCalibrationFailed,
    LocatedCamera,
    doubts,
    find_camera,
)
from pack_perception.depth.registration import Registration, register
from pack_perception.depth.tool_shape import ToolShape
from pack_perception.perception_config import RegistrationConfig
from pack_sim.packing.depth_cameras import DepthCameraSystem
from pack_sim.packing.simulator import Simulator

PLACES = ((-0.09, -0.07), (0.0, -0.07), (0.09, -0.07), (0.09, 0.07), (0.0, 0.07), (-0.09, 0.07), (0.0, 0.0))
"""Of the cup, from the container's middle, x and y [m]."""
HEIGHTS = (0.02, 0.055)
"""Of the cup over the container's rim [m]."""
TILT = np.deg2rad(25.0)
"""Of the pump [rad]: an upright cylinder does not tell how high a camera hangs."""
TURN = 2.4
"""From the direction of one posture's tilt to that of the next [rad]: no two are alike."""
UPRIGHT = 4
"""Every so many postures the pump is upright."""
FRAMES = 3
"""Images of each camera at a posture."""
REST, PATIENCE = 0.004, 2.0
"""Joint speed below which the arm stands still [rad/s], and longest wait for that [s]."""
PERIOD = 0.02
"""Time between two steps of the job [s]."""
EVERY = 3
"""Every many pixels of a row or column one tells where the container is."""
CHECKED = 3
"""A check visits every so many of the postures."""
FAR = 10.0
"""Farther off no camera can be [m]."""
CHECK_SHIFT, CHECK_TURN = 0.001, np.deg2rad(0.15)
"""Farthest that a camera may be from where its calibration has it when that is checked [m] and [rad]."""

OnView = Callable[[int, int], None]
"""Called with the number of postures that were seen, and that of all."""


@dataclass(frozen=True)
class CameraCalibration:
    """What a calibration found.

    Attributes:
        found: each camera.
        container: how far off each camera, as calibrated, sees the container; None: it sees too little of it.
        seconds: simulated time that it took [s].
    """

    found: tuple[LocatedCamera, ...]
    container: tuple[Registration | None, ...]
    seconds: float

    def file(self, cell: PackingCell, preset: str) -> DepthCalibration:
        """The content of its file."""
        described = [PoseConfig.from_pose(camera.X_WC) for camera in cell.depth.cameras()]
        cameras = [
            FoundCamera(
                name=name, pose=PoseConfig.from_pose(found.camera.X_WC),
                shift=_point(found.off.shift), turn=_point(found.off.turn),
                sigma_shift=found.sigma_shift, sigma_turn=found.sigma_turn,
                residual=found.residual, postures=len(found.places),
            )
            for name, found in zip(cell.depth.names, self.found, strict=True)
        ]  # fmt: skip
        return DepthCalibration(
            preset=preset, described=tuple(described), cameras=tuple(cameras), simulated_s=self.seconds
        )


def _point(v: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in v)
    return x, y, z


def postures(cell: PackingCell) -> list[Pose]:
    """Where the cup is at each posture, and how it is turned from upright, one after the other."""
    container = cell.scene.container
    found: list[Pose] = []
    for height in HEIGHTS:
        for x, y in PLACES if not found else PLACES[::-1]:
            k = len(found)
            axis = np.array([np.cos(TURN * k), np.sin(TURN * k), 0.0])
            tilt = exp((0.0 if k % UPRIGHT == 0 else TILT) * axis)
            p = np.array([*container.centre, container.height]) + np.array([x, y, height])
            found.append(Pose(p, tilt))
    return found


class CameraCalibrationRun:
    """Brings the pump to postures and keeps what the cameras measure there.

    Args:
        cell: the cell's physical facts.
        config: parameters of the run.
        seed: seed of where the cameras truly hang, and of their noise.

    Attributes:
        cameras: the cameras as they truly hang.
    """

    def __init__(self, cell: PackingCell, config: LockstepConfig, seed: int) -> None:
        self._cell, self._config = cell, config
        new = handed_over(cell.scene.new_object, cell)
        scene = Scene(
            container=cell.scene.container, friction=cell.scene.friction, objects=[], new_object=new
        )
        self._simulator = Simulator(cell, scene, config.simulator, np.random.default_rng(seed))
        self.cameras = DepthCameraSystem(cell.depth, np.random.default_rng([seed, 2]))
        self._port = FillPort()
        tallest = 2.0 * float(new.half_extents[2])
        self._moves = CupMoves(self._port, cell, config.session.fill, self._simulator.description, tallest)
        self._views: list[ArmView] = []

    @property
    def seconds(self) -> float:
        """Simulated time so far [s]."""
        return self._simulator.time

    def look(self) -> Array:
        """One image of each camera as the arm stands `(cameras, height, width)` [m]."""
        return self.cameras.capture(self._simulator.model, self._simulator.data, self._simulator.time).images

    def views(self, places: Sequence[Pose], on_view: Callable[[int], None]) -> list[ArmView]:
        """What is seen with the cup at places, turned from upright; `on_view` is told how many were seen."""
        self._views = []
        task = TaskRun(self._visit(places, on_view))
        while not task.is_over:
            joints = self._simulator.joints()
            force, _ = self._simulator.external_wrench()
            self._port.seen = FillObservation(joints, _nothing(joints.time), force, False)
            task.go_on()
            command = self._port.command.setpoints
            if command is not None:
                with suppress(MessageError):  # as in the running cell the arm then brakes
                    self._simulator.accept(command)
            self._advance(PERIOD)
        if task.failure:
            raise CameraCalibrationFailed(task.failure)
        return self._views

    def _advance(self, duration: float) -> None:
        for _ in range(round(duration / self._simulator.config.timestep)):
            self._simulator.step()

    def _visit(self, places: Sequence[Pose], on_view: Callable[[int], None]) -> Steps[None]:
        upright = multiply(from_yaw(self._moves.arm.home_heading), POINTING_DOWN)
        for place in places:
            way = place.p - self._moves.cup.p
            yield from self._moves.move(
                [way], self._moves.pace(self._config.session.fill.speed), multiply(place.q, upright)
            )
            yield from self._port.wait(self._rests, PATIENCE)  # the driver holds the arm meanwhile
            self._take()
            on_view(len(self._views))

    def _take(self) -> None:
        """Take images at the rate of the cameras while the arm stands still."""
        simulator, qs, frames = self._simulator, [], []
        for _ in range(FRAMES):
            qs.append(simulator.joints().q)
            frames.append(self.look())
            self._advance(1.0 / self._cell.depth.rate)
        self._views.append(ArmView(np.mean(qs, axis=0), np.stack(frames)))

    def _rests(self) -> bool:
        return bool(np.abs(self._port.seen.joints.v).max() < REST)


def _nothing(time: float) -> SceneState:
    """No object is seen."""
    return SceneState(time, {})


def calibrate(
    cell: PackingCell, config: LockstepConfig, seed: int, on_view: OnView = lambda *_: None
) -> CameraCalibration:
    """Calibrate the depth cameras of the cell of a seed.

    Args:
        cell: the cell as it is described.
        config: parameters of the run.
        seed: seed of where the cameras truly hang, and of their noise.
        on_view: called with the number of postures that were seen, and that of all.

    Raises:
        CameraCalibrationFailed: a camera sees too little, or what it sees does not agree.
    """
    run, visited = CameraCalibrationRun(cell, config, seed), postures(cell)
    images = run.look()
    views = run.views(visited, lambda number: on_view(number, len(visited)))
    found = find_cameras(cell, cell.depth.cameras(), views, CameraCalibrationConfig())
    container = [container_seen(cell, one.camera, image) for one, image in zip(found, images, strict=True)]
    return CameraCalibration(found, tuple(container), run.seconds)


def find_cameras(
    cell: PackingCell, described: Sequence[PinholeCamera], views: Sequence[ArmView],
    config: CameraCalibrationConfig,
) -> tuple[LocatedCamera, ...]:  # fmt: skip
    """Where all cameras hang.

    Raises:
        CameraCalibrationFailed: one sees too little, or what it sees does not agree.
    """
    tool, container = ToolShape.of(cell), cell.scene.container
    middle = np.array([*container.centre, 0.5 * container.height])
    found, reasons = [], []
    for number, (name, camera) in enumerate(zip(cell.depth.names, described, strict=True)):
        try:
            one = find_camera(camera, number, views, tool, middle, config)
        except CameraCalibrationFailed as failure:
            reasons.append(f"{name}: {failure}")
            continue
        found.append(one)
        reasons += [f"{name}: {reason}" for reason in doubts(one, config)]
    if reasons:
        raise CameraCalibrationFailed(f"the calibration is not to be trusted. {' '.join(reasons)}")
    return tuple(found)


def container_seen(cell: PackingCell, camera: PinholeCamera, image: Array) -> Registration | None:
    """How far off a camera sees the container; None: it sees too little of it."""
    container, config = cell.scene.container, RegistrationConfig()
    return register(points_of(camera, image, EVERY), camera.X_WC.p, container, config)


@dataclass(frozen=True)
class CheckedCamera:
    """How far a camera now is from where its calibration has it.

    Attributes:
        name: of the camera.
        shift: at the container [m].
        turn: [rad].
    """

    name: str
    shift: float
    turn: float

    @property
    def holds(self) -> bool:
        """Whether its calibration still holds."""
        return self.shift <= CHECK_SHIFT and self.turn <= CHECK_TURN


def check(
    cell: PackingCell, config: LockstepConfig, seed: int, calibration: DepthCalibration,
    on_view: OnView = lambda *_: None,
) -> tuple[CheckedCamera, ...]:  # fmt: skip
    """Test a calibration on the cell of a seed, at some of the postures.

    Raises:
        CameraCalibrationFailed: a camera sees too little, or what it sees does not agree.
        ConfigError: the calibration is of other cameras.
    """
    run, visited = CameraCalibrationRun(cell, config, seed), postures(cell)[::CHECKED]
    views = run.views(visited, lambda number: on_view(number, len(visited)))
    # how far off a camera is, is what is asked: it is no reason not to say it
    few = CameraCalibrationConfig(postures=len(visited) - 1, sigma=CHECK_SHIFT, shift=FAR, turn_deg=180.0)
    found = find_cameras(cell, calibration.applied(cell.depth), views, few)
    return tuple(
        CheckedCamera(name, float(np.linalg.norm(one.off.shift)), float(np.linalg.norm(one.off.turn)))
        for name, one in zip(cell.depth.names, found, strict=True)
    )
