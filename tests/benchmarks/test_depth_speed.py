"""Processor time of a depth camera's rays, of a look at objects that nobody described, and of tracking."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.ndimage import median_filter

from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import DepthFrame
from pack_core.packing.scene import Scene
from pack_core.rotations import rotate
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_perception.depth.depth_estimator import DepthEstimator
from pack_perception.perception_config import PerceptionConfig
from pack_sim.packing.camera_rays import REACH, CameraRays
from pack_sim.packing.depth_cameras import DepthCameraSystem
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator

pytestmark = pytest.mark.benchmark
SEEDS = range(3, 8)
"""Scenes that are looked at, of the seeds for tuning."""
STEPS = 60
"""Of the physics before the images are taken [ms]."""
ROUNDS = 3
"""How often each scene is looked at."""
PERIOD = 67
"""Steps of the physics between two images [ms]."""
FRAMES = 5
"""Images that are tracked after each look."""
WINDOW = (1, 7, 7)
"""Of the median filter that a look is compared with: camera, rows, columns [pixels]."""


@dataclass(frozen=True)
class Moment:
    """What perception has when it looks, and what comes after: joint samples, and the images after them."""

    scene: Scene
    cell: PackingCell
    config: PerceptionConfig
    joints: list[JointSample]
    frame: DepthFrame
    later: list[tuple[list[JointSample], DepthFrame]]

    def estimator(self) -> DepthEstimator:
        """An estimator that has not looked yet."""
        estimator = DepthEstimator(self.scene, self.cell, self.config)
        for sample in self.joints:
            estimator.advance(sample)
        return estimator


@pytest.fixture(scope="module")
def moments() -> list[Moment]:
    preset = load_preset("unknown")
    cell, config = preset.packing_cell(), lockstep_config(preset)
    found = []
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        simulator = Simulator(cell, generate_scene(seed, cell), config.simulator, rng)
        cameras = DepthCameraSystem(cell.depth, rng)
        first = [simulator.joints()]
        (joints, frame), *later = [
            exposed_after(simulator, cameras, steps) for steps in (STEPS, *[PERIOD] * FRAMES)
        ]
        description = simulator.description
        found.append(Moment(description, cell, config.estimator, first + joints, frame, later))
    return found


def exposed_after(
    simulator: Simulator, cameras: DepthCameraSystem, steps: int
) -> tuple[list[JointSample], DepthFrame]:
    """Joint samples of some more steps, and the images at their end."""
    joints = []
    for _ in range(steps):
        simulator.step()
        joints.append(simulator.joints())
    return joints, cameras.capture(simulator.model, simulator.data, simulator.time)


def processor_time(call: Callable[[], object]) -> float:
    """Processor time of a call [s]: other work on the machine does not count."""
    start = time.process_time()
    call()
    return time.process_time() - start


def test_a_look_takes_at_most_as_long_as_two_and_a_half_median_filters_of_its_images(
    benchmark: BenchmarkFixture, moments: list[Moment]
) -> None:
    """The filter tells how fast the machine is now; a look takes 1.4 filters."""
    moments[0].estimator().see(moments[0].frame)  # what is compiled or read at first does not count
    looks = [(moment.estimator(), moment.frame) for moment in moments for _ in range(ROUNDS)]
    times = []

    def all_of_them() -> None:
        for estimator, frame in looks:
            look = processor_time(lambda e=estimator, f=frame: e.see(f))  # type: ignore[misc]
            times.append((look, processor_time(lambda f=frame: median_filter(f.images, WINDOW))))  # type: ignore[misc]

    benchmark.pedantic(all_of_them)
    assert all(estimator.knows_objects for estimator, _ in looks)
    look, filtered = np.median(times, axis=0)
    benchmark.extra_info.update(look_ms=1e3 * look, filter_ms=1e3 * filtered)
    assert look <= 2.5 * filtered


def test_a_frame_of_tracking_takes_at_most_a_tenth_of_a_median_filter_of_its_images(
    benchmark: BenchmarkFixture, moments: list[Moment]
) -> None:
    times = []

    def all_of_them() -> None:
        for moment in moments:
            estimator = moment.estimator()
            estimator.see(moment.frame)
            for joints, frame in moment.later:
                for sample in joints:
                    estimator.advance(sample)
                tracked = processor_time(lambda e=estimator, f=frame: e.see(f))  # type: ignore[misc]
                times.append((tracked, processor_time(lambda f=frame: median_filter(f.images, WINDOW))))  # type: ignore[misc]

    benchmark.pedantic(all_of_them)
    tracked, filtered = np.median(times, axis=0)
    benchmark.extra_info.update(frame_ms=1e3 * tracked, filter_ms=1e3 * filtered)
    assert tracked <= filtered / 10.0


def test_the_rays_of_a_camera_take_at_most_a_fifth_of_those_that_mujoco_casts_singly(
    benchmark: BenchmarkFixture,
) -> None:
    preset = load_preset("unknown")
    cell, config = preset.packing_cell(), lockstep_config(preset)
    camera = cell.depth.cameras()[0]
    v, u = np.indices((camera.height, camera.width))
    rays = np.stack([(u - camera.c[0]) / camera.f, (v - camera.c[1]) / camera.f, np.ones(u.shape)], axis=-1)
    lengths = np.linalg.norm(rays, axis=-1, keepdims=True)
    directions = rotate(camera.X_WC.q, (rays / lengths).reshape(-1, 3)).ravel()
    distances, normals, geoms = np.empty(v.size), np.empty(3 * v.size), np.empty(v.size, dtype=np.int32)
    cast, times = CameraRays(camera), []

    def singly(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        mujoco.mj_multiRay(
            model, data, camera.X_WC.p, directions, None, True, -1, geoms, distances, normals, v.size, REACH
        )  # fmt: skip

    def all_of_them() -> None:
        for seed in SEEDS:
            rng = np.random.default_rng(seed)
            simulator = Simulator(cell, generate_scene(seed, cell), config.simulator, rng)
            for _ in range(ROUNDS):
                both = (cast.cast, singly)
                times.append([processor_time(partial(f, simulator.model, simulator.data)) for f in both])

    benchmark.pedantic(all_of_them)
    ours, theirs = np.median(times, axis=0)
    benchmark.extra_info.update(rays_ms=1e3 * ours, single_rays_ms=1e3 * theirs)
    assert ours <= theirs / 5.0
