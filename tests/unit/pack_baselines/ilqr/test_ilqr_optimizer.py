"""iLQR on the packing problem."""

import numpy as np
import pytest

from pack_baselines.ilqr.ilqr import cheapest
from pack_baselines.ilqr.ilqr_optimizer import IlqrOptimizer, IlqrOptimizerConfig
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.robots.panda import PANDA
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import load_weights
from pack_mpc.target import PackingTarget, Stage

ABOVE = PackingTarget(np.array([0.45, 0.05, 0.30]), 0.2)


@pytest.fixture
def optimizer(scene: Scene) -> IlqrOptimizer:
    return IlqrOptimizer(scene.description(), packing_cell(), IlqrOptimizerConfig(), threads=2)


@pytest.fixture
def cost(optimizer: IlqrOptimizer) -> PackingCost:
    weights = load_weights("tuned")
    residuals = Residuals(optimizer.plant, weights, ABOVE)
    return PackingCost(residuals, weights.pre_pack, weights.torque)


def test_iterations_from_one_state_never_raise_the_cost(optimizer, cost, joints, state) -> None:
    x0 = optimizer.plant.state(joints, state)
    costs = [optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE).cost for _ in range(6)]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < 0.5 * cheapest(optimizer.plant, cost, x0, np.zeros((100, 7))[None])[0].cost


def test_only_objects_that_move_are_in_the_state(optimizer, cost, joints, state) -> None:
    x0 = optimizer.plant.state(joints, state)
    trajectory = cheapest(optimizer.plant, cost, x0, np.zeros((100, 7))[None])[0]
    assert optimizer.touched(trajectory) == []
    trajectory.xs[50, optimizer.plant.layout.object_p["tea_box"]] += 0.002
    assert optimizer.touched(trajectory) == ["tea_box"]


def test_the_full_state_has_what_nothing_touches_and_finds_the_same_free_motion(
    optimizer, cost, joints, state, scene: Scene
) -> None:
    full = IlqrOptimizer(scene.description(), packing_cell(), IlqrOptimizerConfig(full_state=True), threads=2)
    x0 = full.plant.state(joints, state)
    weights = load_weights("tuned")
    of_all = PackingCost(Residuals(full.plant, weights, ABOVE), weights.pre_pack, weights.torque)
    solutions = [
        full.improve(x0, of_all, Stage.PRE_PACK, ABOVE),
        optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE),
    ]
    # objects at rest far below the arm add nothing but numerical noise to its plan
    np.testing.assert_allclose(solutions[0].setpoints.q, solutions[1].setpoints.q, atol=1e-4)
    trajectory = cheapest(full.plant, of_all, x0, np.zeros((100, 7))[None])[0]
    assert len(full._columns(trajectory)) == 2 * (7 + 6 * len(scene.names))
    assert len(optimizer._columns(trajectory)) == 2 * 7


def test_a_plan_that_diverges_is_replaced_by_gravity_compensation(optimizer, cost, joints, state) -> None:
    x0 = optimizer.plant.state(joints, state)
    optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE)
    optimizer._last.us[:] = PANDA.limits.effort
    solution = optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE)
    assert "started afresh" in solution.warning
    assert np.abs(solution.setpoints.v).max() < 2.5
