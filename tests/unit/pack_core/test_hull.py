"""Convex hulls against closed forms."""

import numpy as np
import pytest

from pack_core.hull import extremes, hull_of, with_fewer_corners

BOX = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 3.0) for z in (0.0, 4.0)])
BALL = np.random.default_rng(0).normal(size=(5000, 3))
BALL /= np.linalg.norm(BALL, axis=1, keepdims=True)


def test_a_box_with_points_inside_is_its_eight_corners() -> None:
    hull = hull_of(np.concatenate([BOX, BOX * 0.5 + [0.1, 0.2, 0.3]]))
    assert len(hull.corners) == 8
    assert hull.volume == pytest.approx(24.0)
    np.testing.assert_allclose(hull.centroid, [1.0, 1.5, 2.0])
    np.testing.assert_allclose(hull.heights(np.array([[1.0, 1.5, 4.5], [1.0, 1.5, 3.0]])), [0.5, -1.0])


def test_faces_run_counter_clockwise_as_seen_from_outside() -> None:
    hull = hull_of(BALL)
    a, b, c = np.moveaxis(hull.triangles, 1, 0)
    assert np.all(np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.normals) > 0.0)


@pytest.mark.parametrize(
    ("height", "volume"), [(-1.0, 0.0), (0.0, 0.0), (1.0, 6.0), (4.0, 24.0), (9.0, 24.0)]
)
def test_volume_below_a_height(height: float, volume: float) -> None:
    assert hull_of(BOX).volume_below(height) == pytest.approx(volume)


def test_rays_leave_where_the_faces_are() -> None:
    points, normals = hull_of(BOX).exits(
        np.array([1.0, 1.0, 1.0]), np.array([[1.0, 0.0, 0.0], [0.0, 0.5, 1.5]])
    )
    np.testing.assert_allclose(points, [[2.0, 1.0, 1.0], [1.0, 2.0, 4.0]])
    np.testing.assert_allclose(normals, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], atol=1e-12)


def test_fewer_corners_keep_the_size_and_lose_little() -> None:
    full = hull_of(BALL)
    few = with_fewer_corners(extremes(full), 120, 0.0)
    assert len(few.corners) == 120
    np.testing.assert_allclose(np.ptp(few.corners, axis=0), np.ptp(full.corners, axis=0), rtol=1e-12)
    assert few.heights(full.corners).max() < 0.05


def test_corners_that_lose_nothing_are_not_taken() -> None:
    assert len(with_fewer_corners(hull_of(BOX), 120, 1e-9).corners) == 8


@pytest.mark.parametrize(
    "points", [BOX[:4], BOX * [1.0, 1.0, 0.0], np.zeros((8, 3))], ids=["face", "flat", "point"]
)
def test_points_without_a_volume_are_refused(points: np.ndarray) -> None:
    with pytest.raises(ValueError, match="span a volume"):
        hull_of(points)
