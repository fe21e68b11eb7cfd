"""Poses from markers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pack_core.packing.cell import packing_cell
from pack_core.rotations import Array, Pose, angle_between, exp, to_matrix
from pack_perception.mocap.rigid_body_fit import FitConfig, FitRefusal, Mask, align, fit_rigid_bodies

CONFIG = FitConfig()
SCENE = packing_cell().scene
ITEMS = (*SCENE.objects, SCENE.new_object)

vectors = arrays(float, 3, elements=st.floats(-1.0, 1.0))
subsets = arrays(bool, 6).filter(lambda mask: mask.sum() >= 3)


def fit(p_BM: Array, p_WM: Array, visible: Mask) -> tuple[Pose | FitRefusal, float]:
    fits = fit_rigid_bodies(p_BM[None], p_WM[None], visible[None], CONFIG)
    return fits.refusals[0] or Pose(fits.p_WB[0], fits.q_WB[0]), float(fits.residual[0])


@given(p=vectors, turn=vectors, visible=subsets, item=st.sampled_from(ITEMS))
@settings(max_examples=300)
def test_any_pose_is_recovered_from_any_three_or_more_markers(
    p: Array, turn: Array, visible: Mask, item: object
) -> None:
    X_WB, p_BM = Pose(p, exp(np.pi * turn)), item.markers()
    p_WM = np.where(visible[:, None], X_WB.apply(p_BM), 99.0)
    found, residual = fit(p_BM, p_WM, visible)
    assert isinstance(found, Pose)
    assert np.allclose(found.p, X_WB.p, atol=1e-9)
    assert angle_between(found.q, X_WB.q) < 1e-6
    assert residual < 1e-9


def test_bodies_in_one_batch_do_not_disturb_each_other() -> None:
    rng = np.random.default_rng(0)
    p_BM = np.stack([item.markers() for item in ITEMS])
    truth = [Pose(rng.normal(size=3), exp(rng.normal(size=3))) for _ in ITEMS]
    p_WM = np.stack([X.apply(p) for X, p in zip(truth, p_BM, strict=True)])
    visible = np.ones(p_BM.shape[:2], dtype=bool)
    visible[2] = False
    fits = fit_rigid_bodies(p_BM, p_WM, visible, CONFIG)
    assert [r for r in fits.refusals if r] == [FitRefusal.TOO_FEW]
    for i in (0, 1, 3, 4, 5):
        assert np.allclose(fits.p_WB[i], truth[i].p, atol=1e-9)


def test_noise_moves_the_pose_by_about_its_own_size() -> None:
    rng = np.random.default_rng(1)
    p_BM, visible = ITEMS[0].markers(), np.ones(6, dtype=bool)
    X_WB = Pose(np.array([0.5, 0.1, 0.06]), exp(np.array([0.0, 0.0, 0.7])))
    errors = []
    for _ in range(200):
        found, _ = fit(p_BM, X_WB.apply(p_BM) + rng.normal(0.0, 0.0003, p_BM.shape), visible)
        assert isinstance(found, Pose)
        errors.append(np.linalg.norm(found.p - X_WB.p))
    assert 0.0001 < np.mean(errors) < 0.001


def test_two_markers_are_refused() -> None:
    p_BM = ITEMS[0].markers()
    visible = np.array([True, True, False, False, False, False])
    assert fit(p_BM, p_BM, visible)[0] is FitRefusal.TOO_FEW


def test_markers_on_a_line_are_refused() -> None:
    p_BM = np.linspace(0.0, 0.1, 4)[:, None] * np.array([1.0, 2.0, 0.5])
    assert fit(p_BM, p_BM, np.ones(4, dtype=bool))[0] is FitRefusal.COLLINEAR


@pytest.mark.parametrize("swap", [(0, 1), (2, 5)])
def test_mistaken_markers_are_refused_where_too_few_are_left_without_them(swap: tuple[int, int]) -> None:
    p_BM = ITEMS[2].markers()
    p_WM = p_BM.copy()
    p_WM[list(swap)] = p_WM[list(swap[::-1])]
    visible = np.isin(np.arange(6), [*swap, 3, 4])
    assert fit(p_BM, p_WM, visible)[0] is FitRefusal.RESIDUAL


def test_a_mirrored_body_is_never_fitted_by_a_reflection() -> None:
    p_BM = ITEMS[2].markers()
    found, _ = fit(p_BM, p_BM * np.array([1.0, 1.0, -1.0]), np.ones(6, dtype=bool))
    assert found is FitRefusal.RESIDUAL


@given(p=vectors, turn=vectors, item=st.sampled_from(ITEMS), false=st.integers(0, 5))
@settings(max_examples=100)
def test_a_marker_that_is_not_there_is_left_out(p: Array, turn: Array, item: object, false: int) -> None:
    X_WB, p_BM = Pose(p, exp(np.pi * turn)), item.markers()
    p_WM = X_WB.apply(p_BM)
    p_WM[false] += [0.05, 0.0, 0.02]
    found, _ = fit(p_BM, p_WM, np.ones(6, dtype=bool))
    assert isinstance(found, Pose)
    assert np.allclose(found.p, X_WB.p, atol=1e-9)


@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (3, 4), (4, 5)])
@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.name)
def test_two_markers_that_are_taken_for_each_other_never_give_a_wrong_pose(
    item: object, pair: tuple[int, int]
) -> None:
    X_WB, p_BM = Pose(np.array([0.5, 0.1, 0.06]), exp(np.array([0.0, 0.0, 0.7]))), item.markers()
    p_WM = X_WB.apply(p_BM)
    p_WM[list(pair)] = p_WM[list(reversed(pair))]
    found, _ = fit(p_BM, p_WM, np.ones(6, dtype=bool))
    assert isinstance(found, FitRefusal) or np.linalg.norm(found.p - X_WB.p) < 0.003


RECTANGLE = np.array([[0.05, 0.02, 0.0], [-0.05, 0.02, 0.0], [-0.05, -0.02, 0.0], [0.05, -0.02, 0.0]])
ALL = np.ones((1, 4), dtype=bool)


def test_the_spread_of_a_rectangle_is_half_its_shorter_side() -> None:
    turned = Pose(np.array([0.3, 0.1, 0.2]), exp(np.array([0.4, -0.2, 0.7]))).apply(RECTANGLE)
    np.testing.assert_allclose(align(RECTANGLE[None], turned[None], ALL).spread, 0.02)


@pytest.mark.parametrize("scale", [0.9, 1.03])
def test_the_residual_of_a_body_that_has_grown_is_its_growth(scale: float) -> None:
    found = align(RECTANGLE[None] + 0.1, scale * RECTANGLE[None] + 0.3, ALL)
    np.testing.assert_allclose(found.residual, abs(scale - 1.0) * np.hypot(0.05, 0.02))
    np.testing.assert_allclose(found.p_WB, [[0.2, 0.2, 0.2]])


def test_one_marker_alone_tells_the_place_of_a_body_that_is_not_turned() -> None:
    found = align(RECTANGLE[None], RECTANGLE[None] + 0.5, np.eye(1, 4, dtype=bool))
    np.testing.assert_allclose(found.p_WB, [[0.5, 0.5, 0.5]])
    np.testing.assert_allclose(found.q_WB, [[1.0, 0.0, 0.0, 0.0]])


def test_of_each_body_of_a_batch_as_many_markers_are_left_out_as_are_false() -> None:
    item = ITEMS[2]
    p_BM = np.repeat(item.markers()[None], 4, axis=0)
    p_WM, visible = p_BM + 0.2, np.ones((4, 6), dtype=bool)
    p_WM[1, 0] += [0.05, 0.0, 0.02]
    p_WM[2, [0, 4]] += [[0.05, 0.0, 0.02], [0.0, 0.07, -0.03]]
    p_WM[3, 1] += [0.0, 0.04, 0.06]
    visible[3, 5] = False
    fits = fit_rigid_bodies(p_BM, p_WM, visible, CONFIG)
    assert fits.refusals == (None,) * 4
    np.testing.assert_array_equal(fits.left_out, [0, 1, 2, 1])
    np.testing.assert_allclose(fits.p_WB, 0.2, atol=1e-9)


@pytest.mark.parametrize(("allowed", "false"), [(0, 1), (1, 2), (2, 3)])
def test_no_more_markers_are_left_out_than_allowed(allowed: int, false: int) -> None:
    p_BM = ITEMS[2].markers()
    p_WM = p_BM.copy()
    p_WM[:false] += [[0.05, 0.0, 0.02], [0.0, 0.07, -0.03], [-0.02, 0.03, 0.09]][:false]
    config = FitConfig(max_left_out=allowed)
    fits = fit_rigid_bodies(p_BM[None], p_WM[None], np.ones((1, 6), dtype=bool), config)
    assert fits.refusals == (FitRefusal.RESIDUAL,)
    assert fits.left_out == [0]


@pytest.mark.parametrize(("share", "is_refused"), [(0.99, False), (1.01, True)])
def test_a_fit_is_refused_beyond_its_bounds(share: float, is_refused: bool) -> None:
    growth = share * CONFIG.max_residual / np.hypot(0.05, 0.02)
    narrow = RECTANGLE * [1.0, CONFIG.min_spread / share / 0.02, 1.0]
    for p_BM, p_WM, refusal in (
        (RECTANGLE, (1.0 + growth) * RECTANGLE, FitRefusal.RESIDUAL),
        (narrow, narrow, FitRefusal.COLLINEAR),
    ):
        fits = fit_rigid_bodies(p_BM[None], p_WM[None], ALL, CONFIG)
        assert fits.refusals == (refusal if is_refused else None,)


@pytest.mark.parametrize(("share", "left_out"), [(0.97, 0), (1.03, 1)])
def test_a_marker_is_left_out_only_where_all_of_them_together_miss(share: float, left_out: int) -> None:
    p_BM, visible = SCENE.model_of("cracker_box").markers()[None], np.ones((1, 6), dtype=bool)
    way = np.zeros((1, 6, 3))
    way[0, 1, 0] = 0.001  # without any one of the others the residual is 5 % larger, so only this one can go
    # The residual of a small displacement is proportional to it.
    growth = share * CONFIG.max_residual / align(p_BM, p_BM + way, visible).residual[0]
    fits = fit_rigid_bodies(p_BM, p_BM + growth * way, visible, CONFIG)
    assert fits.refusals == (None,)
    assert fits.left_out == [left_out]


def kabsch(p_BM: Array, p_WM: Array) -> Array:
    """The rotation by the textbook: U diag(1, 1, det) V^T of numpy's decomposition."""
    U, _, Vt = np.linalg.svd((p_WM - p_WM.mean(axis=0)).T @ (p_BM - p_BM.mean(axis=0)))
    return np.asarray(U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt)


@given(
    markers=arrays(float, (6, 3), elements=st.floats(-1.0, 1.0)), flat=st.booleans(), mirrored=st.booleans()
)
@settings(max_examples=200)
def test_the_rotation_is_kabschs_also_of_flat_and_of_mirrored_markers(
    markers: Array, flat: bool, mirrored: bool
) -> None:
    rng = np.random.default_rng(0)
    p_BM = markers * np.array([1.0, 1.0, 0.0 if flat else 1.0]) + rng.normal(size=(6, 3)) * [0.1, 0.1, 0.0]
    X_WB = Pose(rng.normal(size=3), exp(rng.normal(size=3)))
    p_WM = X_WB.apply(p_BM * np.array([1.0, 1.0, -1.0 if mirrored else 1.0])) + rng.normal(0.0, 1e-3, (6, 3))
    H = (p_WM - p_WM.mean(axis=0)).T @ (p_BM - p_BM.mean(axis=0))
    moments = np.linalg.svd(H, compute_uv=False)
    found = align(p_BM[None], p_WM[None], np.ones((1, 6), dtype=bool))
    assert found.spread[0] == pytest.approx(np.sqrt(moments[1] / 6))
    R = to_matrix(found.q_WB[0])
    best = np.trace(kabsch(p_BM, p_WM).T @ H)
    assert np.trace(R.T @ H) == pytest.approx(best, abs=1e-12)  # the maximum, which two rotations may share


@pytest.mark.parametrize("count", [0, 1, 2])
def test_of_fewer_than_three_markers_it_still_gives_a_pose_that_fits_them(count: int) -> None:
    p_BM, visible = ITEMS[0].markers(), np.arange(6) < count
    X_WB = Pose(np.array([0.5, 0.1, 0.06]), exp(np.array([0.3, 0.0, 0.7])))
    found = align(p_BM[None], X_WB.apply(p_BM)[None], visible[None])
    assert np.linalg.norm(found.q_WB[0]) == pytest.approx(1.0)
    assert np.isfinite(found.p_WB).all()
    assert found.residual[0] < 1e-9
