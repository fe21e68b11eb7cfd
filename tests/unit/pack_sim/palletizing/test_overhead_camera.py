"""Pictures agree with the projection, and taking them holds nobody up."""

from __future__ import annotations

import queue
import subprocess
import sys

import cv2
import numpy as np
import pytest

from pack_core.camera import Picture
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.palletizing.view import CellView
from pack_core.rotations import Array, Pose, from_yaw
from pack_sim.camera_thread import CameraThread
from pack_sim.palletizing.overhead_camera import (
    STRIP_ROWS,
    PalletCamera,
    PalletCameraConfig,
    Snapshot,
    camera_of,
)

CONFIG = PalletCameraConfig(width=960)
BOX = BoxBody("box", (0.5, 0.35, 0.3), 8.0)
X_WB = Pose(np.array([-2.45, 2.56, 0.85]), from_yaw(np.deg2rad(8.0)))


def seen(boxes: dict[BoxBody, Pose]) -> Snapshot:
    return Snapshot(1.5, np.array(palletizing_cell().arm.home), boxes)


def top_corners() -> Array:
    x, y, z = BOX.half_extents
    return X_WB.apply(np.array([[x, y, z], [x, -y, z], [-x, -y, z], [-x, y, z]]))


@pytest.fixture(scope="module")
def pictures() -> tuple[Picture, Picture]:
    """Of the empty table, and of one with a box."""
    with PalletCamera(palletizing_cell(), CONFIG) as camera:
        return camera.picture(seen({})), camera.picture(seen({BOX: X_WB}))


def test_a_picture_has_the_size_of_the_camera(pictures: tuple[Picture, Picture]) -> None:
    camera = camera_of(palletizing_cell(), CONFIG)
    assert pictures[0].shape == (camera.height, camera.width, 3) == (540, 960, 3)


def test_a_picture_in_strips_is_the_whole_picture() -> None:
    """All but pixels at edges, whose multisampling is rounded differently, one in ten thousand."""
    config = PalletCameraConfig(width=1600)
    camera = camera_of(palletizing_cell(), config)
    assert camera.height >= 2 * STRIP_ROWS
    with CellView(palletizing_cell(), camera.width, camera.height) as view:
        whole = view.picture(np.array(palletizing_cell().arm.home), {BOX: X_WB}, camera)
    with PalletCamera(palletizing_cell(), config) as cut:
        assert (whole != cut.picture(seen({BOX: X_WB}))).any(axis=2).mean() < 1e-4


def test_the_last_strip_may_overlap_the_one_before() -> None:
    config = PalletCameraConfig(width=1000, shadows=False)
    camera = camera_of(palletizing_cell(), config)
    assert camera.height % STRIP_ROWS
    with CellView(palletizing_cell(), camera.width, camera.height, shadows=False) as view:
        whole = view.picture(np.array(palletizing_cell().arm.home), {BOX: X_WB}, camera)
    with PalletCamera(palletizing_cell(), config) as cut:
        assert (whole != cut.picture(seen({BOX: X_WB}))).any(axis=2).mean() < 1e-4


def test_the_simulator_holds_no_large_textures_no_buffers_for_whole_pictures_and_no_compiler() -> None:
    """A node without them holds 0.4 GB; the board as a cube adds 200 MB, buffers 400, numba 100."""
    model = build_model(palletizing_cell(), visuals=True)
    assert model.ntexdata < 30e6
    assert model.vis.global_.offheight < 2 * STRIP_ROWS  # as large as the buffers are at least
    code = "import sys, pack_sim.palletizing.pallet_sim_node; raise SystemExit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_top_of_a_box_is_seen_where_it_is_projected(pictures: tuple[Picture, Picture]) -> None:
    """Its outline in the picture against its projected corners, to half a pixel (2 mm)."""
    brightness = cv2.cvtColor(pictures[1], cv2.COLOR_RGB2HSV)[:, :, 2]
    projected = camera_of(palletizing_cell(), CONFIG).project(top_corners())
    lower, upper = projected.min(axis=0).astype(int) - 25, projected.max(axis=0).astype(int) + 25
    part = brightness[lower[1] : upper[1], lower[0] : upper[0]]
    _, mask = cv2.threshold(part, 0, 255, cv2.THRESH_OTSU)
    outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    (u, v), size, _ = cv2.minAreaRect(max(outlines, key=cv2.contourArea))
    np.testing.assert_allclose(np.array([u, v]) + lower, projected.mean(axis=0), atol=0.5)
    sides = np.linalg.norm(projected[[1, 2]] - projected[[0, 1]], axis=1)
    np.testing.assert_allclose(np.sort(np.array(size) + 1.0), np.sort(sides), atol=1.5)


def test_a_box_casts_a_shadow_on_the_table(pictures: tuple[Picture, Picture]) -> None:
    camera = camera_of(palletizing_cell(), CONFIG)
    inside = cv2.fillPoly(
        np.zeros(pictures[0].shape[:2], np.uint8), [camera.project(top_corners()).astype(np.int32)], 1
    )
    darker = pictures[0].mean(axis=2) - pictures[1].mean(axis=2) > 10.0
    assert np.count_nonzero(darker & (inside == 0)) > 300


def test_a_scaled_camera_sees_the_same_with_other_pixels() -> None:
    full = palletizing_cell().overhead_camera
    half = full.scaled(full.width // 2)
    corner = top_corners()[0]
    np.testing.assert_allclose(half.project(corner) + 0.5, (full.project(corner) + 0.5) / 2)


def test_one_picture_at_a_time_is_taken_and_delivered_with_its_time() -> None:
    taken: queue.Queue[tuple[float, Picture]] = queue.Queue()
    errors: list[str] = []
    camera = PalletCamera(palletizing_cell(), CONFIG.model_copy(update={"shadows": False}))
    thread = CameraThread(camera, lambda *args: taken.put(args), errors.append)
    assert thread.expose(1.5, seen({BOX: X_WB}))
    assert not thread.expose(1.5, seen({}))
    time, picture = taken.get(timeout=60.0)
    thread.close()
    assert (time, picture.shape) == (1.5, (540, 960, 3))
    assert not thread.expose(1.5, seen({}))
    assert errors == []


@pytest.mark.parametrize(
    ("rate", "asked", "exposed"),
    [
        (0.0, 0.123, 0.123),
        (60.0, 0.1, 0.1),
        (60.0, 0.104, 7 / 60),
        (60.0, 10 / 60, 10 / 60),
        (10.0, 0.0, 0.0),
    ],
)
def test_a_picture_is_the_first_frame_that_is_not_older_than_the_request(
    rate: float, asked: float, exposed: float
) -> None:
    assert PalletCameraConfig(rate=rate).exposure_time(asked) == pytest.approx(exposed)
