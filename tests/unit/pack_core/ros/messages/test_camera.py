"""Pictures and cameras as messages: what belongs together comes back, all else is refused."""

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, Image

from pack_core.camera import PinholeCamera, focal_length
from pack_core.errors import MessageError
from pack_core.ros.messages.camera import (
    from_camera_info,
    from_depth_image,
    from_image,
    to_camera_info,
    to_depth_image,
    to_image,
)
from pack_core.ros.messages.point_cloud import to_depth_cloud

CAMERA = PinholeCamera.looking_down([0.5, 0.0, 1.2], focal_length(42.0, 48), 64, 48)
PICTURE = np.arange(64 * 48 * 3, dtype=np.uint8).reshape(48, 64, 3)


def information() -> CameraInfo:
    return to_camera_info(1.5, CAMERA, "camera")


def picture(rgb: np.ndarray = PICTURE) -> Image:
    return to_image(1.5, rgb, "camera")


def test_a_picture_and_its_camera_come_back() -> None:
    camera = from_camera_info(information(), CAMERA.X_WC)
    assert (camera.f, camera.c, camera.width, camera.height) == (CAMERA.f, CAMERA.c, 64, 48)
    np.testing.assert_array_equal(from_image(picture(), camera), PICTURE)


@pytest.mark.parametrize("rows", [24, 36])
def test_a_picture_of_another_size_than_the_cameras_is_refused(rows: int) -> None:
    with pytest.raises(MessageError, match=f"picture of 64 x {rows} but intrinsics of 64 x 48"):
        from_image(picture(PICTURE[:rows]), CAMERA)


@pytest.mark.parametrize("change", [{"encoding": "bgr8"}, {"step": 200}, {"data": bytes(100)}, {"height": 0}])
def test_a_picture_of_another_kind_or_a_part_of_one_is_refused(change: dict[str, object]) -> None:
    message = picture()
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(MessageError, match="allowed: rgb8, 3 bytes a pixel"):
        from_image(message, CAMERA)


def test_depths_come_back_in_whole_millimetres() -> None:
    depth = np.random.default_rng(0).uniform(0.3, 1.5, (48, 64))
    depth[::7] = 0.0
    message = to_depth_image(1.5, depth, "depth_1")
    assert (message.encoding, message.step, len(message.data)) == ("16UC1", 128, 48 * 128)
    assert from_depth_image(message, CAMERA) == pytest.approx(np.rint(1e3 * depth) / 1e3)


def test_depths_are_points_that_the_camera_sees_at_their_pixels_and_none_where_nothing_was_measured() -> None:
    depth = np.random.default_rng(0).uniform(0.3, 1.5, (48, 64))
    depth[::7] = 0.0
    message = to_depth_cloud(1.5, depth, CAMERA, "depth_1")
    assert (message.header.frame_id, message.height, message.width, message.is_dense) == (
        "depth_1", 48, 64, False,
    )  # fmt: skip
    points = np.frombuffer(message.data, dtype="<f4").reshape(48, 64, 3)
    np.testing.assert_array_equal(np.isnan(points).all(axis=-1), depth == 0.0)
    v, u = np.nonzero(depth)
    assert points[v, u, 2] == pytest.approx(depth[v, u], rel=1e-6)
    pixels = CAMERA.project(CAMERA.X_WC.apply(points[v, u].astype(float)))
    assert pixels == pytest.approx(np.column_stack([u, v]), abs=1e-3)


@pytest.mark.parametrize("change", [{"encoding": "32FC1"}, {"is_bigendian": 1}, {"step": 64}, {"height": 24}])
def test_a_depth_image_of_another_kind_or_size_is_refused(change: dict[str, object]) -> None:
    message = to_depth_image(1.5, np.ones((48, 64)), "depth_1")
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(MessageError, match="depth image of 64 x"):
        from_depth_image(message, CAMERA)


@pytest.mark.parametrize(("x", "y"), [(2, 1), (1, 2), (4, 4)])
def test_a_camera_that_bins_its_pixels_is_refused(x: int, y: int) -> None:
    message = information()
    message.binning_x, message.binning_y = x, y
    with pytest.raises(MessageError, match="allowed: none, K is about whole pictures"):
        from_camera_info(message, CAMERA.X_WC)


@pytest.mark.parametrize("field", ["x_offset", "y_offset", "width", "height"])
def test_so_is_one_that_sends_a_part_of_its_picture(field: str) -> None:
    message = information()
    setattr(message.roi, field, 8)
    with pytest.raises(MessageError, match=r"a region of .* pixels"):
        from_camera_info(message, CAMERA.X_WC)


def test_a_region_that_is_the_whole_picture_and_no_binning_are_none() -> None:
    message = information()
    message.binning_x = message.binning_y = 1
    message.roi.width, message.roi.height = 64, 48
    assert from_camera_info(message, CAMERA.X_WC).f == CAMERA.f
