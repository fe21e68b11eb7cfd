"""Residuals and their derivatives."""

import numpy as np
import pytest

from pack_mpc.ilqr import Linearization
from pack_mpc.residuals import Residuals, Target
from pack_mpc.weights import WeightSet, load_weights

TARGET = Target(np.array([0.48, 0.02, 0.09]), 0.3, collisions=("tea_box", "soup_can"))


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
    values = Residuals(plant, weights, TARGET).values(plant.state(joints, state)[None], ys)
    np.testing.assert_allclose(values[0, :9], 0.0, atol=1e-4)


def test_an_obstacle_repels_most_where_the_target_is(plant, joints, state, weights) -> None:
    residuals, x = Residuals(plant, weights, TARGET), plant.state(joints, state)
    y = np.zeros(plant.model.nsensordata)
    at, away = x.copy(), x.copy()
    at[plant.layout.object_p["tea_box"][:2]] = TARGET.p_WN[:2]
    away[plant.layout.object_p["tea_box"][:2]] = TARGET.p_WN[:2] + np.array([0.3, 0.4])
    assert residuals.values(at, y)[-2] == pytest.approx(1.0, abs=1e-5)
    assert residuals.values(away, y)[-2] == pytest.approx(np.exp(-0.5))


def test_table_1_is_the_papers() -> None:
    insert = load_weights("table_1").insert
    assert insert.running.position == (1, 1, 1)
    assert insert.terminal.position == (100, 100, 200)
    assert insert.running.joint_velocity == (0.15, 0.02, 0.15, 0.02, 0.02, 0.02, 0.02)
    assert insert.running.obstacle == insert.terminal.obstacle == 1
