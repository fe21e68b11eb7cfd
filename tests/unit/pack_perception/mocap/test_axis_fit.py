"""Poses from as few as two markers and the expected direction of the axis."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.scene_item import TOP_MARKERS
from pack_core.rotations import Array, Pose, angle_between, exp, from_yaw, log, multiply, rotate
from pack_perception.mocap.rigid_body_fit import FitRefusal, Mask
from pack_perception.mocap.sighting import AxisFitConfig, Z, fit_with_axis

CONFIG = AxisFitConfig()
SCENE = packing_cell().scene
ITEMS = (*SCENE.objects, SCENE.new_object)
BOX = ITEMS[2]
HERE = np.zeros(2)
NOISE = 0.0005
"""Of a marker's coordinate in the preset `hardware` [m]."""

angles = st.floats(-np.pi, np.pi)
vectors = arrays(float, 3, elements=st.floats(-1.0, 1.0))
items = st.sampled_from(ITEMS)
tops = st.permutations(range(TOP_MARKERS)).map(lambda order: order[:2])


def standing(item: Box | Cylinder, place: Array, yaw: float) -> Pose:
    return Pose(np.array([*place[:2], item.half_extents[2]]), from_yaw(yaw))


def those(*markers: int) -> Mask:
    return np.isin(np.arange(6), markers)


def fit(
    item: Box | Cylinder, p_WM: Array, visible: Mask, expected: Pose, *, is_known: bool
) -> Pose | FitRefusal:
    pose, known = np.concatenate([expected.p, expected.q]), np.array([is_known])
    fits = fit_with_axis(item.markers()[None], p_WM[None], visible[None], pose[None], known, CONFIG)
    return fits.refusals[0] or Pose(fits.p_WB[0], fits.q_WB[0])


def fit_standing(item: Box | Cylinder, p_WM: Array, *markers: int) -> Pose | FitRefusal:
    """What is believed at first sight, when an object is somewhere else as far as anybody knows."""
    return fit(item, p_WM, those(*markers), standing(item, np.array([-5.0, 3.0]), 0.0), is_known=False)


@given(place=vectors, yaw=angles, pair=tops, item=items)
@settings(max_examples=200)
def test_any_standing_pose_is_recovered_from_any_two_markers_of_the_top(
    place: Array, yaw: float, pair: list[int], item: Box | Cylinder
) -> None:
    X_WB = standing(item, place, yaw)
    p_WM = np.where(those(*pair)[:, None], X_WB.apply(item.markers()), 99.0)
    found = fit_standing(item, p_WM, *pair)
    assert isinstance(found, Pose)
    assert np.allclose(found.p, X_WB.p, atol=1e-9)
    assert angle_between(found.q, X_WB.q) < 1e-6


@given(
    p=vectors,
    turn=vectors,
    about_axis=angles,
    pair=st.permutations(range(6)).map(lambda o: o[:2]),
    item=items,
)
@settings(max_examples=200)
def test_any_pose_is_recovered_from_two_markers_when_its_axis_is_known(
    p: Array, turn: Array, about_axis: float, pair: list[int], item: Box | Cylinder
) -> None:
    X_WB = Pose(p, exp(np.pi * turn))
    expected = Pose(p + 0.02, multiply(X_WB.q, from_yaw(about_axis)))
    p_WM = np.where(those(*pair)[:, None], X_WB.apply(item.markers()), 99.0)
    found = fit(item, p_WM, those(*pair), expected, is_known=True)
    if np.linalg.norm(np.diff(item.markers()[pair, :2], axis=0)) < 2 * CONFIG.min_spread:
        assert found is FitRefusal.COLLINEAR
        return
    assert isinstance(found, Pose)
    assert np.allclose(found.p, X_WB.p, atol=1e-7)
    assert angle_between(found.q, X_WB.q) < 1e-6


@given(tilt=st.floats(-0.2, 0.2))
@settings(max_examples=50)
def test_a_tilt_about_the_line_through_both_markers_is_the_expected_one(tilt: float) -> None:
    """Markers 0 and 2 lie along x."""
    expected = Pose(np.array([0.5, 0.0, 0.1]), exp(np.array([tilt, 0.0, 0.0])))
    p_WM = standing(BOX, HERE, 0.0).apply(BOX.markers())
    found = fit(BOX, p_WM, those(0, 2), expected, is_known=True)
    assert isinstance(found, Pose)
    assert np.allclose(log(found.q), [tilt, 0.0, 0.0], atol=1e-9)
    assert np.allclose(found.apply(BOX.markers())[[0, 2]], p_WM[[0, 2]], atol=1e-9)


@given(tilt=st.floats(-0.02, 0.02))
@settings(max_examples=50)
def test_a_tilt_along_the_line_is_shared_by_squared_distances(tilt: float) -> None:
    """Markers 0 and 2 lie along x: a rotation about y is told by them and by the axis."""
    assume(abs(tilt) > 1e-3)
    S = 2 * BOX.markers()[2, 0] ** 2
    p_WM = Pose(np.zeros(3), exp(np.array([0.0, tilt, 0.0]))).apply(BOX.markers())
    found = fit(BOX, p_WM, those(0, 2), Pose(np.zeros(3)), is_known=True)
    assert isinstance(found, Pose)
    assert log(found.q)[1] / tilt == pytest.approx(S / (S + CONFIG.arm**2), rel=1e-3)


def noisy_fits(item: Box | Cylinder, visible: Mask, yaw: float) -> tuple[Array, Array]:
    """Errors of the yaw `(k,)` [rad] and of the place `(k, 2)` [m] at first sights of a standing object."""
    k, X_WB, p_BM = 5000, standing(item, HERE, yaw), item.markers()
    p_WM = X_WB.apply(p_BM) + np.random.default_rng(1).normal(0.0, NOISE, (k, *p_BM.shape))
    poses, p_BMs, seen = (np.broadcast_to(x, (k, *x.shape)) for x in (np.r_[X_WB.p, X_WB.q], p_BM, visible))
    fits = fit_with_axis(p_BMs, p_WM, seen, poses, np.zeros(k, dtype=bool), CONFIG)
    assert set(fits.refusals) == {None}
    assert np.all(rotate(fits.q_WB, Z)[:, 2] > np.cos(5e-4))
    return log(fits.q_WB)[:, 2] - yaw, fits.p_WB[:, :2]


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_noise_goes_into_yaw_and_place_as_the_distance_of_the_markers_says(item: Box | Cylinder) -> None:
    p_BM = item.markers()
    baseline, reach = np.linalg.norm(p_BM[0] - p_BM[2]), np.linalg.norm((p_BM[0] + p_BM[2])[:2] / 2)
    yaw_errors, place_errors = noisy_fits(item, those(0, 2), 0.0)
    # markers 0 and 2 lie along x, so the origin lies across the line through them, and yaw moves it along x
    along = NOISE * np.sqrt(1 / 2 + 2 * (reach / baseline) ** 2)
    assert np.std(yaw_errors) == pytest.approx(NOISE * np.sqrt(2) / baseline, rel=0.05)
    assert np.std(place_errors, axis=0) == pytest.approx([along, NOISE / np.sqrt(2)], rel=0.05)


@pytest.mark.parametrize("markers", [(0, 1), (0, 3), (0, 1, 2), (0, 1, 2, 3)])
def test_the_yaw_is_as_good_as_the_squared_distances_of_the_markers(markers: tuple[int, ...]) -> None:
    p_BM = BOX.markers()[list(markers), :2]
    yaw_errors, _ = noisy_fits(BOX, those(*markers), 0.4)
    assert np.std(yaw_errors) == pytest.approx(NOISE / np.linalg.norm(p_BM - p_BM.mean(axis=0)), rel=0.05)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
@pytest.mark.parametrize("turn", [[np.pi / 2, 0.0, 0.0], [0.0, np.pi / 2, 0.0], [np.pi, 0.0, 0.0]])
@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (0, 3), (1, 3)])
def test_a_fallen_object_is_not_taken_for_standing(
    item: Box | Cylinder, turn: list[float], pair: tuple[int, int]
) -> None:
    q = exp(np.array(turn))
    corners = item.half_extents * np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    X_WB = Pose(np.array([0.5, 0.0, -rotate(q, corners)[:, 2].min()]), q)
    assert isinstance(fit_standing(item, X_WB.apply(item.markers()), *pair), FitRefusal)


@pytest.mark.parametrize(("share", "is_believed"), [(0.9, True), (1.1, False)])
def test_a_leaning_object_is_refused_when_its_markers_are_higher_than_the_residual(
    share: float, is_believed: bool
) -> None:
    """Leaning by a over its lower edge at -x, a box has its markers across that edge d sin(a) higher."""
    x, _, z = BOX.half_extents
    edge = np.array([-x, 0.0, -z])
    q = exp(np.array([0.0, -np.arcsin(share * CONFIG.max_residual / (x + BOX.markers()[2, 0])), 0.0]))
    X_WB = Pose(np.array([-x, 0.0, 0.0]) - rotate(q, edge), q)
    found = fit_standing(BOX, X_WB.apply(BOX.markers()), 2, 3)
    assert (found is not FitRefusal.NOT_STANDING) is is_believed


def test_an_object_on_top_of_something_is_not_taken_for_standing_on_the_base() -> None:
    lifted = standing(BOX, HERE, 0.3).apply(BOX.markers()) + np.array([0.0, 0.0, 0.004])
    assert fit_standing(BOX, lifted, 0, 1) is FitRefusal.NOT_STANDING


def test_mistaken_markers_are_refused_where_they_are_at_another_distance() -> None:
    p_WM = standing(BOX, HERE, 0.3).apply(BOX.markers())
    p_WM[[2, 3]] = p_WM[[3, 2]]
    assert fit_standing(BOX, p_WM, 0, 2) is FitRefusal.RESIDUAL


def test_one_marker_tells_no_yaw_and_is_refused() -> None:
    assert fit_standing(BOX, standing(BOX, HERE, 0.0).apply(BOX.markers()), 3) is FitRefusal.TOO_FEW


def test_markers_above_each_other_tell_no_yaw_and_are_refused() -> None:
    p_BM = np.array([[0.03, 0.0, 0.01], [0.03, 0.0, 0.05]])[None]
    two, known = np.ones((1, 2), dtype=bool), np.ones(1, dtype=bool)
    fits = fit_with_axis(p_BM, p_BM, two, np.eye(1, 7, 3), known, CONFIG)
    assert fits.refusals == (FitRefusal.COLLINEAR,)
