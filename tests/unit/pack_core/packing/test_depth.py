import numpy as np
import pytest

from pack_core.camera import PinholeCamera, looking_at
from pack_core.packing.cell import packing_cell
from pack_core.packing.depth import FramePairing, points_of
from pack_core.rotations import Array


def test_the_error_of_depth_grows_with_its_square() -> None:
    noise = packing_cell().depth.noise
    near, far = noise.axial([0.5, 1.0])
    assert far == pytest.approx(4.0 * near)
    # one pixel of disparity d = f b / z is z^2 / (f b) of depth
    assert far == pytest.approx(noise.disparity / (noise.matching_focal * noise.baseline))


def test_points_are_seen_where_they_were_measured() -> None:
    camera = PinholeCamera(looking_at([1.0, 0.4, 0.7], [0.5, 0.0, 0.1]), 300.0, (39.5, 29.5), 80, 60)
    rng = np.random.default_rng(0)
    image = np.where(rng.random((60, 80)) < 0.5, rng.uniform(0.5, 1.0, (60, 80)), 0.0)
    points = points_of(camera, image)
    v, u = np.nonzero(image)
    assert camera.project(points) == pytest.approx(np.column_stack([u, v]))
    assert camera.X_WC.inverse().apply(points)[:, 2] == pytest.approx(image[v, u])


def test_of_every_third_pixel_are_a_ninth_of_the_points() -> None:
    camera = packing_cell().depth.cameras()[0]
    image = np.full((camera.height, camera.width), 0.7)
    every = points_of(camera, image).reshape(camera.height, camera.width, 3)
    assert points_of(camera, image, 3) == pytest.approx(every[::3, ::3].reshape(-1, 3))


def test_a_camera_has_what_it_looks_at_in_the_middle_and_its_rows_level() -> None:
    cameras = packing_cell().depth
    for mount, camera in zip(cameras.mounts, cameras.cameras(), strict=True):
        assert camera.project(mount.target) == pytest.approx(camera.c)
        left, right = camera.at_height([[0.0, camera.c[1]], [camera.width - 1.0, camera.c[1]]], 0.06)
        assert left[2] == pytest.approx(right[2])


def test_the_cameras_see_the_whole_base_and_the_whole_rim() -> None:
    cell = packing_cell()
    container = cell.scene.container
    lower, upper = container.lower, container.upper
    corners = [
        [x, y, z] for x in (lower[0], upper[0]) for y in (lower[1], upper[1]) for z in (0.0, container.height)
    ]
    for camera in cell.depth.cameras():
        pixels = camera.project(corners)
        assert np.all((pixels >= 0.0) & (pixels < [camera.width, camera.height]))


def filled(value: float) -> Array:
    return np.full((2, 3), value)


def test_a_frame_is_complete_when_every_camera_has_brought_its_image() -> None:
    pairing = FramePairing(2, 0.3)
    assert pairing.add(1, 1.0, filled(0.2)) is None
    frame = pairing.add(0, 1.0, filled(0.1))
    assert frame is not None
    assert frame.time == 1.0
    assert frame.images == pytest.approx(np.stack([filled(0.1), filled(0.2)]))
    assert pairing.silent == ()


def test_an_image_that_was_lost_costs_its_frame_alone() -> None:
    pairing = FramePairing(2, 0.3)
    assert pairing.add(0, 1.0, filled(0.1)) is None
    assert pairing.add(0, 1.1, filled(0.1)) is None
    assert pairing.add(1, 1.0, filled(0.2)) is None  # a newer frame has begun
    assert pairing.add(1, 1.1, filled(0.2)) is not None


def test_a_camera_that_died_is_not_waited_for_and_is_when_it_is_back() -> None:
    pairing = FramePairing(2, 0.35)
    frames = [pairing.add(0, time, filled(0.1)) for time in (1.0, 1.1, 1.2, 1.3, 1.4)]
    assert [frame is not None for frame in frames] == [False, False, False, False, True]
    assert pairing.silent == (1,)
    assert frames[-1] is not None
    assert not frames[-1].images[1].any()
    pairing.add(1, 1.5, filled(0.2))
    assert pairing.silent == ()
    assert pairing.add(0, 1.5, filled(0.1)) is not None


def test_frames_go_on_when_time_begins_anew() -> None:
    pairing = FramePairing(2, 0.3)
    for time in (7.0, 0.1):
        assert pairing.add(0, time, filled(0.1)) is None
        assert pairing.add(1, time, filled(0.2)) is not None
