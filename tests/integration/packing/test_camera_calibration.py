"""`pack calibrate packing`: cameras are found by the arm's own pump, or refused with the reason."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from pack_bringup.packing.goals import PackingJob, calibration_overrides
from pack_core.camera import PinholeCamera
from pack_core.errors import ConfigError
from pack_core.packing.depth import DepthMount
from pack_core.packing.depth_calibration import load_depth_calibration
from pack_core.rotations import Array, angle_between
from pack_lockstep.packing.camera_calibration import (
    CameraCalibration,
    CameraCalibrationRun,
    container_seen,
    find_cameras,
    postures,
)
from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config
from pack_perception.depth.camera_calibration import (
    ArmView,
    CameraCalibrationConfig,
    CameraCalibrationFailed,
    LocatedCamera,
    doubts,
)
from pack_perception.depth.registration import Registration
from pack_sim.packing.depth_cameras import DepthCameraSystem

PRESET = load_preset("installed")
CELL = PRESET.packing_cell()
CONFIG = CameraCalibrationConfig()
CONTAINER = CELL.scene.container
MIDDLE = np.array([*CONTAINER.centre, 0.5 * CONTAINER.height])
SEED = 500
KNOCKED_FROM = 7
"""Posture from which the cameras of `Seen.knocked` hang 1.5 mm elsewhere."""


@dataclass(frozen=True)
class Seen:
    """What was seen in one run, and the truth."""

    cameras: list[PinholeCamera]
    views: list[ArmView]
    knocked: list[ArmView]
    container: Array


@pytest.fixture(scope="module")
def seen() -> Seen:
    run = CameraCalibrationRun(CELL, lockstep_config(PRESET), SEED)
    knocked = DepthCameraSystem(
        CELL.depth.model_copy(update={"mounts": [aside(mount) for mount in CELL.depth.mounts]}),
        np.random.default_rng([SEED, 2]),
    )
    late: dict[int, Array] = {}

    def note(number: int) -> None:
        if number > KNOCKED_FROM:
            true = run.cameras
            run.cameras = knocked
            late[number - 1], run.cameras = run.look()[None], true

    container = run.look()
    views = run.views(postures(CELL)[: CONFIG.postures], note)
    knocked = [replace(view, images=late.get(i, view.images)) for i, view in enumerate(views)]
    return Seen(run.cameras.cameras, views, knocked, container)


@pytest.fixture(scope="module")
def found(seen: Seen) -> tuple[LocatedCamera, ...]:
    """The cameras, described 8 mm and 0.7 degrees from where they hang."""
    described = [moved(camera, 0.008, 0.7) for camera in seen.cameras]
    return find_cameras(CELL, described, seen.views, CONFIG)


def aside(mount: DepthMount) -> DepthMount:
    """The mount, 1.5 mm along x."""
    (x, y, z), (u, v, w) = mount.position, mount.target
    return DepthMount(position=(x + 0.0015, y, z), target=(u + 0.0015, v, w))


def moved(camera: PinholeCamera, shift: float, turn_deg: float) -> PinholeCamera:
    """A camera elsewhere: by `shift` [m] and `turn_deg` [deg] about the container's middle."""
    along, about = np.array([2.0, -1.0, 2.0]) / 3.0, np.array([-1.0, 2.0, 2.0]) / 3.0
    return Registration(MIDDLE, shift * along, np.deg2rad(turn_deg) * about).applied_to(camera)


def test_cameras_that_hang_8_mm_and_0_7_degrees_elsewhere_are_found(
    seen: Seen, found: tuple[LocatedCamera, ...]
) -> None:
    for one, true in zip(found, seen.cameras, strict=True):
        middle = one.camera.X_WC.apply(true.X_WC.inverse().apply(MIDDLE))
        assert np.linalg.norm(middle - MIDDLE) < 3e-4
        assert np.rad2deg(angle_between(one.camera.X_WC.q, true.X_WC.q)) < 0.06
        # the standard deviations say so themselves, and are no larger than the accuracy that is asked for
        assert np.linalg.norm(middle - MIDDLE) < 5.0 * one.sigma_shift < 1e-3
        assert doubts(one, CONFIG) == []


def test_the_container_is_then_seen_in_its_place(seen: Seen, found: tuple[LocatedCamera, ...]) -> None:
    for one, image in zip(found, seen.container, strict=True):
        off = container_seen(CELL, one.camera, image)
        assert off is not None
        assert np.linalg.norm(off.shift) < 5e-4


def test_too_few_postures_are_refused(seen: Seen) -> None:
    with pytest.raises(
        CameraCalibrationFailed, match=r"depth_2: it sees the pump at 8 postures of 8; needed"
    ):
        find_cameras(CELL, CELL.depth.cameras(), seen.views[:8], CONFIG)


def test_a_covered_lens_is_refused(seen: Seen) -> None:
    dark = [
        replace(view, images=view.images * np.array([1.0, 0.0, 1.0])[:, None, None]) for view in seen.views
    ]
    with pytest.raises(CameraCalibrationFailed, match=r"^[^:]*\. depth_2: it sees the pump at 0 postures"):
        find_cameras(CELL, CELL.depth.cameras(), dark, CONFIG)


def test_a_place_that_is_not_known_well_enough_is_doubtful(found: tuple[LocatedCamera, ...]) -> None:
    (doubt,) = doubts(found[0], CameraCalibrationConfig(sigma=1e-5))
    assert re.search(r"its place is known to 0\.\d\d mm; allowed: 0\.01 mm", doubt)


def test_cameras_that_are_knocked_meanwhile_are_refused(seen: Seen) -> None:
    with pytest.raises(CameraCalibrationFailed, match="Was the camera knocked meanwhile"):
        find_cameras(CELL, CELL.depth.cameras(), seen.knocked, CONFIG)


def test_a_camera_far_from_its_described_place_is_doubtful(found: tuple[LocatedCamera, ...]) -> None:
    (doubt,) = doubts(found[0], CameraCalibrationConfig(shift=0.005))
    assert re.search(r"off by 8 mm and 0\.7 degrees; allowed: 5 mm", doubt)


def test_its_file_is_for_the_preset_and_the_cameras_that_it_was_made_of(
    found: tuple[LocatedCamera, ...], tmp_path: Path
) -> None:
    path = tmp_path / "calibration.yaml"
    CameraCalibration(found, (None, None), 16.0).file(CELL, "installed").write(path)
    read = load_depth_calibration(path)
    for camera, one in zip(read.applied(CELL.depth), found, strict=True):
        np.testing.assert_allclose(camera.X_WC.p, one.camera.X_WC.p)
        np.testing.assert_allclose(camera.X_WC.q, one.camera.X_WC.q)
    assert calibration_overrides("installed", path) == {"perception": {"calibration": f'"{path}"'}}
    job = PackingJob(folder=tmp_path, preset="installed", calibration=path)
    assert job.overrides()["perception"]["calibration"] == f'"{path}"'
    with pytest.raises(ConfigError, match="under preset 'installed', and this cell has unknown; give"):
        calibration_overrides("unknown", path)
    mounts = [m.model_copy(update={"position": (0.8, 0.4, 0.7)}) for m in CELL.depth.mounts]
    with pytest.raises(ConfigError, match="of cameras that were described elsewhere"):
        read.applied(CELL.depth.model_copy(update={"mounts": mounts}))
    text = yaml.safe_load(path.read_text())
    path.write_text(yaml.safe_dump(text | {"cameras": text["cameras"][:1]}))
    with pytest.raises(ConfigError, match="`cameras` has 1, `described` 3"):
        load_depth_calibration(path)
