"""Place and yaw from as few as two markers, where height and tilt are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pack_core.cells.packing import packing_cell
from pack_core.rotations import Array, Pose, angle_between, exp, from_yaw, log, multiply
from pack_core.scene.objects import TOP_MARKERS, Box, Cylinder
from pack_perception.mocap.planar_fit import PlanarFitConfig, fit_in_plane
from pack_perception.mocap.rigid_body_fit import Mask, Refusal

CONFIG = PlanarFitConfig()
SCENE = packing_cell().scene
ITEMS = (*SCENE.objects, SCENE.new_object)
NOISE = 0.0005
"""Of a marker's coordinate in the preset `hardware` [m]."""

yaws = st.floats(-np.pi, np.pi)
places = arrays(float, 2, elements=st.floats(-1.0, 1.0))
pairs = st.permutations(range(TOP_MARKERS)).map(lambda order: order[:2])


def standing(item: Box | Cylinder, place: Array, yaw: float) -> Pose:
    return Pose(np.array([*place, item.half_extents[2]]), from_yaw(yaw))


def seen(*markers: int) -> Mask:
    return np.isin(np.arange(6), markers)


def fit(item: Box | Cylinder, p_WM: Array, visible: Mask, expected: Pose) -> Pose | Refusal:
    pose = np.concatenate([expected.p, expected.q])
    fits = fit_in_plane(item.markers()[None], p_WM[None], visible[None], pose[None], CONFIG)
    return fits.refusals[0] or Pose(fits.p_WB[0], fits.q_WB[0])


@given(place=places, yaw=yaws, other=yaws, pair=pairs, item=st.sampled_from(ITEMS))
@settings(max_examples=300, deadline=None)
def test_any_standing_pose_is_recovered_from_any_two_markers_of_the_top(
    place: Array, yaw: float, other: float, pair: list[int], item: Box | Cylinder
) -> None:
    X_WB, visible = standing(item, place, yaw), seen(*pair)
    p_WM = np.where(visible[:, None], X_WB.apply(item.markers()), 99.0)
    found = fit(item, p_WM, visible, standing(item, np.array([-5.0, 3.0]), other))
    assert isinstance(found, Pose)
    assert np.allclose(found.p, X_WB.p, atol=1e-9)
    assert angle_between(found.q, X_WB.q) < 1e-6


@given(place=places, yaw=yaws, tilt=arrays(float, 3, elements=st.floats(-0.8, 0.8)), pair=pairs)
@settings(max_examples=100, deadline=None)
def test_an_expected_height_and_tilt_are_kept(place: Array, yaw: float, tilt: Array, pair: list[int]) -> None:
    item, expected = ITEMS[2], Pose(np.array([0.1, 0.2, 0.3]), exp(tilt))
    X_WB = Pose(np.array([*place, 0.3]), multiply(from_yaw(yaw), expected.q))
    found = fit(item, X_WB.apply(item.markers()), seen(*pair), expected)
    if not isinstance(found, Pose):
        assert found is Refusal.TOO_CLOSE
        return
    assert np.allclose(found.p, X_WB.p, atol=1e-9)
    assert angle_between(found.q, X_WB.q) < 1e-6


def noisy_fits(item: Box | Cylinder, visible: Mask, yaw: float) -> tuple[Array, Array]:
    """Errors of the yaw `(k,)` [rad] and of the place `(k, 2)` [m] over many frames."""
    k, X_WB, p_BM = 5000, standing(item, np.zeros(2), yaw), item.markers()
    p_WM = X_WB.apply(p_BM) + np.random.default_rng(1).normal(0.0, NOISE, (k, *p_BM.shape))
    poses, p_BMs, seen_k = (np.broadcast_to(x, (k, *x.shape)) for x in (np.r_[X_WB.p, X_WB.q], p_BM, visible))
    fits = fit_in_plane(p_BMs, p_WM, seen_k, poses, CONFIG)
    assert set(fits.refusals) == {None}
    return log(fits.q_WB)[:, 2] - yaw, fits.p_WB[:, :2]


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_noise_goes_into_yaw_and_place_as_the_distance_of_the_markers_says(item: Box | Cylinder) -> None:
    p_BM = item.markers()
    baseline, reach = np.linalg.norm(p_BM[0] - p_BM[2]), np.linalg.norm((p_BM[0] + p_BM[2])[:2] / 2)
    yaw_errors, place_errors = noisy_fits(item, seen(0, 2), 0.0)
    # markers 0 and 2 lie along x, so the origin lies across the line through them, and yaw moves it along x
    along = NOISE * np.sqrt(1 / 2 + 2 * (reach / baseline) ** 2)
    assert np.std(yaw_errors) == pytest.approx(NOISE * np.sqrt(2) / baseline, rel=0.05)
    assert np.std(place_errors, axis=0) == pytest.approx([along, NOISE / np.sqrt(2)], rel=0.05)


@pytest.mark.parametrize("markers", [(0, 1), (0, 3), (0, 1, 2), (0, 1, 2, 3)])
def test_the_yaw_is_as_good_as_the_squared_distances_of_the_markers(markers: tuple[int, ...]) -> None:
    p_BM = ITEMS[2].markers()[list(markers), :2]
    yaw_errors, _ = noisy_fits(ITEMS[2], seen(*markers), 0.4)
    assert np.std(yaw_errors) == pytest.approx(NOISE / np.linalg.norm(p_BM - p_BM.mean(axis=0)), rel=0.05)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
@pytest.mark.parametrize("turn", [[np.pi / 2, 0.0, 0.0], [0.0, np.pi / 2, 0.0], [np.pi, 0.0, 0.0]])
def test_a_fallen_object_is_not_taken_for_standing(item: Box | Cylinder, turn: list[float]) -> None:
    q = exp(np.array(turn))
    lowest = Pose(np.zeros(3), q).apply(
        item.half_extents * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    )
    X_WB = Pose(np.array([0.5, 0.0, -lowest[:, 2].min()]), q)
    for pair in ((0, 1), (0, 2), (0, 3), (1, 3)):
        found = fit(item, X_WB.apply(item.markers()), seen(*pair), standing(item, np.zeros(2), 0.0))
        assert isinstance(found, Refusal)


@pytest.mark.parametrize(("share", "is_believed"), [(0.9, True), (1.1, False)])
def test_a_tilt_is_told_when_it_lifts_a_marker_beyond_the_residual(share: float, is_believed: bool) -> None:
    """Tilted by a about its lower edge, a box's markers over it stay and those across rise by d sin(a)."""
    item, (x, _, z) = ITEMS[2], ITEMS[2].half_extents
    across = x + item.markers()[2, 0]
    angle = np.arcsin(share * CONFIG.max_residual / across)
    q = exp(np.array([0.0, -angle, 0.0]))
    edge = np.array([-x, 0.0, -z])
    X_WB = Pose(np.array([-x, 0.0, 0.0]) - Pose(np.zeros(3), q).apply(edge[None])[0], q)
    found = fit(item, X_WB.apply(item.markers()), seen(2, 3), standing(item, np.zeros(2), 0.0))
    assert isinstance(found, Pose) is is_believed


def test_an_object_that_stands_on_something_is_not_taken_for_standing_on_the_base() -> None:
    item = ITEMS[2]
    lifted = standing(item, np.zeros(2), 0.3).apply(item.markers()) + np.array([0.0, 0.0, 0.004])
    assert fit(item, lifted, seen(0, 1), standing(item, np.zeros(2), 0.0)) is Refusal.UNEXPECTED


def test_mistaken_markers_are_refused_where_they_are_at_another_distance() -> None:
    item = ITEMS[2]
    p_WM = standing(item, np.zeros(2), 0.3).apply(item.markers())
    p_WM[[2, 3]] = p_WM[[3, 2]]
    assert fit(item, p_WM, seen(0, 2), standing(item, np.zeros(2), 0.0)) is Refusal.UNEXPECTED


def test_one_marker_tells_no_yaw_and_is_refused() -> None:
    item = ITEMS[0]
    p_WM = standing(item, np.zeros(2), 0.0).apply(item.markers())
    assert fit(item, p_WM, seen(3), standing(item, np.zeros(2), 0.0)) is Refusal.TOO_FEW


def test_markers_above_each_other_tell_no_yaw_and_are_refused() -> None:
    p_BM = np.array([[0.03, 0.0, 0.01], [0.03, 0.0, 0.05]])
    fits = fit_in_plane(p_BM[None], p_BM[None], np.ones((1, 2), dtype=bool), np.eye(1, 7, 3), CONFIG)
    assert fits.refusals == (Refusal.TOO_CLOSE,)
