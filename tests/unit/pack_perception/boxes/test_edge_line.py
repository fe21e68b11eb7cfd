"""Edges of drawn half planes are found where they were drawn, to a few hundredths of a pixel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pack_core.camera import PinholeCamera
from pack_core.rotations import Array
from pack_perception.boxes.edge_line import EdgeConfig, TopFace, find_edge

SIZE, HEIGHT = 240, 1.0
CAMERA = PinholeCamera.looking_down([0.0, 0.0, 3.0], 1000.0, SIZE, SIZE)
PIXEL = (3.0 - HEIGHT) / CAMERA.f


def half_plane(angle: float, shift: float, inside: float, outside: float, blur: float = 1.2) -> Array:
    """An edge along `angle` [rad], `shift` pixels to the right of the middle, with `inside` to its left."""
    v, u = np.mgrid[:SIZE, :SIZE].astype(float)
    x, y = u - CAMERA.c[0], CAMERA.c[1] - v
    distance = x * np.sin(angle) - y * np.cos(angle) - shift
    share = 0.5 * (1.0 + np.tanh(distance / blur))
    return np.asarray(inside + (outside - inside) * share)


def search(
    picture: Array, angle: float, offset: float = 0.0, is_dark: bool = False
) -> tuple[float, float, Array]:
    """Where the edge is found: distance to the right of the middle [pixel] and angle [rad]."""
    value = np.clip(np.round(picture), 0, 255).astype(np.uint8)
    face = TopFace(value, (0, 0), CAMERA, HEIGHT, is_dark)
    along = np.array([np.cos(angle), np.sin(angle)])
    outward = np.array([along[1], -along[0]])
    middle = offset * PIXEL * outward
    edge = find_edge(face, middle - 80 * PIXEL * along, middle + 80 * PIXEL * along, EdgeConfig())
    assert edge is not None
    found = np.arctan2(edge.direction[1], edge.direction[0])
    return float(edge.middle @ outward) / PIXEL, float(found), np.array([edge.contrast, edge.inside])


@settings(max_examples=50)
@given(
    angle=st.floats(-np.pi, np.pi),
    shift=st.floats(-3.0, 3.0),
    offset=st.floats(-3.0, 3.0),
    is_dark=st.booleans(),
)
@example(angle=0.005, shift=0.5, offset=0.0, is_dark=False)  # nearly along the pixels, where it is worst
def test_an_edge_is_found_wherever_it_lies(angle: float, shift: float, offset: float, is_dark: bool) -> None:
    levels = (60.0, 190.0) if is_dark else (190.0, 60.0)
    place, found, (contrast, inside) = search(
        half_plane(angle, shift, *levels), angle, shift + offset, is_dark
    )
    assert place == pytest.approx(shift, abs=0.06)
    assert abs((found - angle + np.pi) % (2 * np.pi) - np.pi) < 3e-4
    assert contrast == pytest.approx(130.0, abs=3.0)
    assert inside == pytest.approx(levels[0], abs=3.0)


def test_a_wrong_first_angle_is_corrected() -> None:
    place, found, _ = search(half_plane(0.32, 1.3, 200.0, 40.0), 0.30)
    assert found == pytest.approx(0.32, abs=3e-4)
    assert place == pytest.approx(1.3, abs=0.1)


def test_noise_averages_out() -> None:
    noise = np.random.default_rng(0).normal(0.0, 6.0, (SIZE, SIZE))
    place, found, _ = search(half_plane(0.1, 0.4, 180.0, 60.0) + noise, 0.1)
    assert place == pytest.approx(0.4, abs=0.05)
    assert found == pytest.approx(0.1, abs=1e-3)


def test_what_covers_a_part_of_the_edge_does_not_bend_it() -> None:
    picture = half_plane(0.0, 0.0, 180.0, 60.0)
    picture[: SIZE // 2 + 4, 150:175] = 60.0  # a dark thing reaches 4 pixels over the edge
    place, found, _ = search(picture, 0.0)
    assert place == pytest.approx(0.0, abs=0.05)
    assert found == pytest.approx(0.0, abs=1e-3)


def test_where_there_is_no_edge_the_contrast_says_so() -> None:
    noise = np.random.default_rng(0).normal(0.0, 3.0, (SIZE, SIZE))
    face = TopFace((100.0 + noise).astype(np.uint8), (0, 0), CAMERA, HEIGHT, False)
    edge = find_edge(face, np.array([-0.15, 0.0]), np.array([0.15, 0.0]), EdgeConfig())
    assert edge is None or edge.contrast < 5.0 or edge.inliers < 0.5
