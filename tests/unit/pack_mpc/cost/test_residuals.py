"""Residuals and their derivatives."""

import numpy as np
import pytest

from pack_mpc.cost.cost import Residuals
from pack_mpc.cost.residuals import RESIDUALS, Force, JointLimit, ObstacleResidual, Position, Upright, Yaw
from pack_mpc.cost.weights import WeightSet, load_weights
from pack_mpc.plant import Linearization
from pack_mpc.target import PackingTarget

TARGET = PackingTarget(np.array([0.48, 0.02, 0.09]), 0.3, collisions=("tea_box", "soup_can"))


@pytest.fixture(params=["table_1", "tuned"])
def weights(request) -> WeightSet:
    return load_weights(request.param)


def test_jacobians_agree_with_finite_differences_of_the_residuals(plant, joints, state, weights) -> None:
    """Along x and y apart: the outputs' own derivatives are the plant's business."""
    residuals, rng = Residuals(plant, weights, TARGET), np.random.default_rng(1)
    columns, ny, h = plant.columns(["tea_box", "soup_can"]), plant.model.nsensordata, 1e-6
    xs = np.tile(plant.state(joints, state), (3, 1)) + rng.normal(0, 0.05, (3, plant.nx))
    ys = rng.normal(0, 1.0, (3, ny))
    ys[:, plant.sensor("held_z_axis")] = [0.1, -0.2, 0.97]
    n = len(columns)
    no_outputs = Linearization(
        np.zeros((2, n, n)), np.zeros((2, n, 7)), np.zeros((3, ny, n)), np.zeros((2, ny, 7))
    )
    jx, _ = residuals.jacobians(xs, ys, no_outputs, columns)
    for j, column in enumerate(columns):
        step = h * np.eye(plant.nx)[column]
        expected = (residuals.values(xs + step, ys) - residuals.values(xs - step, ys)) / (2 * h)
        np.testing.assert_allclose(jx[:, :, j], expected, atol=1e-6)
    for k in range(ny):
        C = np.zeros((3, ny, n))
        C[:, k, 0] = 1.0
        jy, _ = residuals.jacobians(
            xs, ys, Linearization(no_outputs.A, no_outputs.B, C, no_outputs.D), columns
        )
        step = h * np.eye(ny)[k]
        expected = (residuals.values(xs, ys + step) - residuals.values(xs, ys - step)) / (2 * h)
        np.testing.assert_allclose(jy[:, :, 0] - jx[:, :, 0], expected, atol=1e-5)


def test_residuals_vanish_at_the_target(plant, joints, state, weights) -> None:
    ys = np.zeros((1, plant.model.nsensordata))
    ys[0, plant.sensor("held_position")] = TARGET.p_WN
    ys[0, plant.sensor("held_x_axis")] = [np.cos(0.3), np.sin(0.3), 0.0]
    ys[0, plant.sensor("held_z_axis")] = [0.0, 0.0, 1.0]
    ys[0, plant.sensor("tip_force")] = [0.0, 0.0, 9.81 * plant.scene.new_object.mass]
    xs = plant.state(joints, state)[None]
    for term in (Position, Upright, Yaw, Force):
        np.testing.assert_allclose(term(plant, TARGET, weights).values(xs, ys), 0.0, atol=1e-4)


@pytest.mark.parametrize("tilt", [0.3, -1.2])
def test_the_tilt_costs_its_angle_or_its_axis(plant, tilt: float) -> None:
    ys = np.zeros(plant.model.nsensordata)
    ys[plant.sensor("held_z_axis")] = [np.sin(tilt), 0.0, np.cos(tilt)]
    angle, axis = (Upright(plant, TARGET, load_weights(name)) for name in ("table_1", "tuned"))
    np.testing.assert_allclose(angle.values(np.zeros(0), ys), [abs(tilt), 0.0])
    np.testing.assert_allclose(axis.values(np.zeros(0), ys), [np.sin(tilt), 0.0])


@pytest.mark.parametrize(("external", "residual"), [(1.9, 0.0), (-1.9, 0.0), (5.0, 3.0), (-5.0, -3.0)])
def test_a_force_within_the_dead_band_costs_nothing(plant, external: float, residual: float) -> None:
    weight = 9.81 * plant.scene.new_object.mass
    force = Force(plant, TARGET, load_weights("tuned"))
    np.testing.assert_allclose(force.of(np.array([0.0, 0.0, weight - external])), [0, 0, residual], atol=1e-6)


def test_a_joint_in_its_middle_costs_nothing_and_one_at_its_limit_most(plant, weights) -> None:
    term, limits = JointLimit(plant, TARGET, weights), plant.arm.limits
    xs = np.zeros((2, plant.nx))
    xs[:, plant.layout.q] = limits.middle, limits.upper
    np.testing.assert_allclose(term.of(xs), [np.zeros(7), np.cosh(limits.upper - limits.middle) - 1.0])


def test_an_obstacle_repels_most_where_the_target_is(plant, joints, state, weights) -> None:
    term, x = ObstacleResidual(plant, TARGET, weights), plant.state(joints, state)
    at, away = x.copy(), x.copy()
    at[plant.layout.object_p["tea_box"][:2]] = TARGET.p_WN[:2]
    away[plant.layout.object_p["tea_box"][:2]] = TARGET.p_WN[:2] + np.array([0.3, 0.4])
    assert term.of(at)[0] == pytest.approx(1.0, abs=1e-5)
    assert term.of(away)[0] == pytest.approx(np.exp(-0.5))


def test_each_row_has_the_weight_of_its_residual(plant, joints, state, weights) -> None:
    residuals = Residuals(plant, weights, TARGET)
    spread = residuals.spread({term.name: float(i) for i, term in enumerate(RESIDUALS)})
    rows = [term(plant, TARGET, weights).rows for term in RESIDUALS]
    np.testing.assert_array_equal(spread, np.repeat(np.arange(len(RESIDUALS)), rows))
    values = residuals.values(plant.state(joints, state), np.zeros(plant.model.nsensordata))
    assert values.shape == spread.shape


def test_a_residual_with_one_weight_a_row_has_them_in_order(plant, weights) -> None:
    nothing = {term.name: 0.0 for term in RESIDUALS}
    spread = Residuals(plant, weights, TARGET).spread(nothing | {"position": (1.0, 2.0, 3.0)})
    assert spread[spread > 0.0].tolist() == [1.0, 2.0, 3.0]


def test_names_of_residuals_are_unique() -> None:
    assert len({term.name for term in RESIDUALS}) == len(RESIDUALS)
