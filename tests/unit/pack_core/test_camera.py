"""Pinhole projection and back."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pack_core.camera import PinholeCamera, focal_length

CAMERA = PinholeCamera.looking_down([-2.5, 2.5, 3.7], focal_length(42.0, 2160), 3840, 2160)
coordinates = st.floats(-0.6, 0.6)


@given(coordinates, coordinates, st.floats(0.0, 1.5))
def test_a_point_is_where_its_pixel_says_at_its_height(x: float, y: float, z: float) -> None:
    p_W = np.array([-2.5 + x, 2.5 + y, z])
    np.testing.assert_allclose(CAMERA.at_height(CAMERA.project(p_W), z), p_W, atol=1e-9)


def test_the_middle_of_the_picture_is_below_the_camera() -> None:
    np.testing.assert_allclose(CAMERA.project([-2.5, 2.5, 0.0]), [1919.5, 1079.5])


def test_right_in_the_picture_is_x_and_up_is_y() -> None:
    u, v = (CAMERA.project([-2.4, 2.6, 0.7]) - CAMERA.c).tolist()
    assert u > 0 > v


def test_one_pixel_is_one_millimetre_at_the_top_of_a_box() -> None:
    pixels = CAMERA.project(np.array([[-2.5, 2.5, 0.9], [-2.4, 2.5, 0.9]]))
    np.testing.assert_allclose(np.diff(pixels[:, 0]), 100.0, rtol=0.01)


def test_the_picture_spans_the_field_of_view() -> None:
    edge = CAMERA.at_height([1919.5, -0.5], 0.7)
    np.testing.assert_allclose(np.rad2deg(np.arctan2(edge[1] - 2.5, 3.0)), 21.0)


def test_the_matrix_projects_as_the_camera_does() -> None:
    p_W = np.array([-2.3, 2.6, 0.9])
    p_C = CAMERA.X_WC.inverse().apply(p_W)
    u, v, w = CAMERA.K @ p_C
    np.testing.assert_allclose([u / w, v / w], CAMERA.project(p_W))
