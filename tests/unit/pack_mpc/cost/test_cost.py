"""The cost of a rollout by its closed form."""

import numpy as np
import pytest

from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.residuals import RESIDUALS, ObstacleResidual
from pack_mpc.cost.weights import StageWeights, load_weights
from pack_mpc.target import PackingTarget, Stage

TARGET = PackingTarget(np.array([0.48, 0.02, 0.09]), 0.3, collisions=("tea_box", "soup_can"))
STEPS = 4


@pytest.fixture
def rollout(plant, joints, state) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States, outputs and torques of three trajectories."""
    rng = np.random.default_rng(0)
    xs = plant.state(joints, state) + rng.normal(0.0, 0.02, (3, STEPS + 1, plant.nx))
    ys = rng.normal(0.0, 0.3, (3, STEPS + 1, plant.model.nsensordata))
    return xs, ys, rng.normal(0.0, 5.0, (3, STEPS, 7))


def test_it_is_the_weighted_sum_of_squares_over_the_horizon(plant, rollout) -> None:
    weights = load_weights("tuned")
    residuals, (xs, ys, us) = Residuals(plant, weights, TARGET), rollout
    insert = weights.of(Stage.INSERT)
    squares = residuals.values(xs, ys) ** 2
    running = (squares[:, :-1] * residuals.spread(insert.running)).sum(axis=(1, 2))
    terminal = (squares[:, -1] * residuals.spread(insert.terminal)).sum(axis=1)
    expected = running + terminal + weights.torque * (us**2).sum(axis=(1, 2))
    np.testing.assert_allclose(PackingCost(residuals, insert, weights.torque).value(xs, ys, us), expected)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.9, 1.0, 3.0])
def test_what_obstacles_cost_falls_to_zero_as_eq_3_says(plant, rollout, share: float) -> None:
    nothing = {term.name: 0.0 for term in RESIDUALS}
    alone = StageWeights(running=nothing | {"obstacle": 2.0}, terminal=nothing | {"obstacle": 5.0})
    weights = load_weights("table_1").model_copy(update={"insert": alone, "obstacle_decay": 3.0})
    residuals, (xs, ys, us) = Residuals(plant, weights, TARGET), rollout
    in_force = weights.in_force(Stage.INSERT, 3.0 * share)
    r = ObstacleResidual(plant, TARGET, weights).values(xs, ys) ** 2
    w_0 = 2.0 * r[:, :-1].sum(axis=(1, 2)) + 5.0 * r[:, -1].sum(axis=1)
    cost = PackingCost(residuals, in_force, 0.0).value(xs, ys, us)
    np.testing.assert_allclose(cost, np.maximum(0.0, w_0 - share * w_0), atol=1e-12)
