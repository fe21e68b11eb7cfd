"""What a real camera makes of a picture."""

import numpy as np
import pytest

from pack_core.camera import LensDistortion, Picture, PinholeCamera, seen_pixels
from pack_core.palletizing.imperfections import CameraErrors
from pack_core.rotations import Array
from pack_perception.boxes.table_camera import Rectifier
from pack_sim.palletizing.overhead_camera import RealLens

CAMERA = PinholeCamera.looking_down([0.0, 0.0, 3.0], 700.0, 960, 540)
LENS = LensDistortion(k1=-0.08, k2=0.02, p1=0.0004, p2=-0.0004)
PURE = CameraErrors(lens=LENS)
POINTS = np.array([[x, y, 0.0] for x in (-1.6, -0.4, 0.5, 1.5) for y in (-0.9, 0.0, 0.8)])


def dots(camera: PinholeCamera) -> Picture:
    """Round white spots, three pixels wide, at the points of the floor."""
    v, u = np.mgrid[: camera.height, : camera.width]
    value = sum(np.exp(-((u - x) ** 2 + (v - y) ** 2) / 18.0) for x, y in camera.project(POINTS))
    return np.repeat(np.clip(255 * np.asarray(value), 0, 255).astype(np.uint8)[..., None], 3, axis=2)


def centroids(picture: Picture, near: Array) -> Array:
    """The middle of each spot `(n, 2)` near a pixel."""
    found = []
    for x, y in np.round(near).astype(int):
        patch = picture[y - 12 : y + 13, x - 12 : x + 13, 0].astype(float)
        v, u = np.mgrid[y - 12 : y + 13, x - 12 : x + 13]
        found.append([np.average(u, weights=patch), np.average(v, weights=patch)])
    return np.array(found)


def test_points_are_seen_where_the_distorted_camera_has_them() -> None:
    lens = RealLens(CAMERA, LENS, PURE, 0)
    wanted = seen_pixels(CAMERA, LENS, POINTS)
    assert np.abs(wanted - CAMERA.project(POINTS)).max() > 5.0
    np.testing.assert_allclose(centroids(lens.expose(dots(lens.drawn), 1.0), wanted), wanted, atol=0.05)


def test_undistorted_points_are_where_a_pinhole_camera_has_them() -> None:
    lens = RealLens(CAMERA, LENS, PURE, 0)
    flat = Rectifier(CAMERA, LENS, CAMERA)(lens.expose(dots(lens.drawn), 1.0))
    wanted = CAMERA.project(POINTS)
    np.testing.assert_allclose(centroids(flat, wanted), wanted, atol=0.06)


def test_light_falls_off_to_the_corners_and_to_one_side() -> None:
    grey = np.full((1000, 1200, 3), 200, dtype=np.uint8)
    lens = RealLens(CAMERA, LensDistortion(), CameraErrors(vignetting=0.25, unevenness=0.2), 3)
    seen = lens.expose(grey[: lens.drawn.height, : lens.drawn.width], 0.0).mean(axis=2)
    corners = [seen[:20, :20], seen[:20, -20:], seen[-20:, :20], seen[-20:, -20:]]
    brightness = [float(corner.mean()) for corner in corners]
    assert seen[260:280, 470:490].mean() == pytest.approx(200, abs=3)
    assert np.mean(brightness) == pytest.approx(150, abs=4)
    assert max(brightness) - min(brightness) > 15


def test_noise_is_that_of_the_electrons_and_repeats_with_the_time() -> None:
    grey = np.full((600, 1100, 3), 128, dtype=np.uint8)
    lens = RealLens(CAMERA, LensDistortion(), CameraErrors(exposure=0.5, read_noise=5.0), 3)
    picture = grey[: lens.drawn.height, : lens.drawn.width]
    seen = lens.expose(picture, 1.0)
    # 128 of 255 are 2510 electrons of the half-used 10,000: sqrt(2510 + 25) of them, 255 / 5000 values each.
    assert seen.std() == pytest.approx(np.sqrt(2510 + 25 + (5000 / 255) ** 2 / 12) * 255 / 5000, rel=0.02)
    np.testing.assert_array_equal(seen, lens.expose(picture, 1.0))
    assert np.any(seen != lens.expose(picture, 2.0))
