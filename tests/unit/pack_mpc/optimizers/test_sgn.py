"""Spline Gauss-Newton on the packing problem."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import load_weights
from pack_mpc.optimizers.sgn import SgnConfig, SgnOptimizer
from pack_mpc.target import PackingTarget, Stage

ABOVE = PackingTarget(np.array([0.45, 0.05, 0.30]), 0.2)
BELOW = np.array([0.5, 0.0, 0.09])


def make(scene: Scene, threads: int = 2) -> SgnOptimizer:
    return SgnOptimizer(scene.description(), packing_cell(), SgnConfig(), threads)


def cost_of(optimizer: SgnOptimizer, target: PackingTarget, stage: Stage = Stage.PRE_PACK) -> PackingCost:
    weights = load_weights("tuned")
    residuals = Residuals(optimizer.plant, weights, target)
    return PackingCost(residuals, weights.of(stage), weights.torque)


@pytest.fixture
def optimizer(scene: Scene) -> SgnOptimizer:
    return make(scene)


@pytest.fixture
def x0(optimizer: SgnOptimizer, joints: JointSample, state: SceneState) -> Array:
    return optimizer.plant.state(joints, state)


def test_iterations_from_one_state_lower_the_cost_and_never_raise_it(optimizer, x0) -> None:
    cost = cost_of(optimizer, ABOVE)
    costs = [optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE).cost for _ in range(6)]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < 0.9 * costs[0]


def test_the_plan_brings_the_held_object_towards_its_target(optimizer, x0) -> None:
    cost = cost_of(optimizer, ABOVE)
    for _ in range(4):
        solution = optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE)
    start, end = (np.linalg.norm(solution.p_WN[i] - ABOVE.p_WN) for i in (0, -1))
    assert end < 0.3 * start


def test_the_plan_does_not_depend_on_the_number_of_threads(scene, optimizer, x0) -> None:
    alone = make(scene, threads=1)
    ours, theirs = (o.improve(x0, cost_of(o, ABOVE), Stage.PRE_PACK, ABOVE) for o in (alone, optimizer))
    np.testing.assert_array_equal(ours.setpoints.q, theirs.setpoints.q)


@pytest.mark.parametrize("may_land", [True, False])
def test_the_object_comes_down_slowly_only_where_it_may_land_on_another(optimizer, x0, may_land) -> None:
    target = PackingTarget(BELOW, 0.0, may_land=may_land)
    solution = optimizer.improve(x0, cost_of(optimizer, target, Stage.INSERT), Stage.INSERT, target)
    fastest = -np.diff(solution.p_WN[:, 2]).min() / SgnConfig().timestep
    assert (fastest < 1.3 * SgnConfig().speed_landing) == may_land


def test_no_rollout_exceeds_the_limits_of_speed(optimizer, x0, monkeypatch) -> None:
    tried, config = [], SgnConfig()
    roll_out = optimizer._roll_out
    monkeypatch.setattr(optimizer, "_roll_out", lambda *args: tried.append(args[-1]) or roll_out(*args))
    for target in (ABOVE, PackingTarget(BELOW, 0.0), PackingTarget(BELOW, 0.0, may_land=True)):
        optimizer.improve(x0, cost_of(optimizer, target, Stage.INSERT), Stage.INSERT, target)
    twists = np.concatenate(tried)
    assert np.all(np.abs(twists[..., :3]) <= config.speed_linear + 1e-9)
    assert np.all(np.abs(twists[..., 3:]) <= config.speed_angular + 1e-9)
    assert np.all(np.concatenate(tried[-2:])[..., 2] >= -config.speed_landing - 1e-9)


def test_a_model_that_diverges_leaves_a_finite_plan(optimizer, x0, monkeypatch) -> None:
    cost = cost_of(optimizer, ABOVE)
    weighted = cost.weighted

    def broken(xs: Array, ys: Array) -> Array:
        values = weighted(xs, ys)
        if len(values) > 1:
            values[1] = np.nan
        return values

    monkeypatch.setattr(cost, "weighted", broken)
    solution = optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE)
    assert np.isfinite(solution.cost)
    assert np.all(np.isfinite(solution.setpoints.q))


def test_an_iteration_that_begins_late_perturbs_the_first_knot_and_one_of_the_others_in_turn(
    optimizer, x0, monkeypatch
) -> None:
    tried, config = [], SgnConfig()
    roll_out = optimizer._roll_out
    monkeypatch.setattr(optimizer, "_roll_out", lambda *args: tried.append(args[-1]) or roll_out(*args))
    cost = cost_of(optimizer, ABOVE)
    for pause in (0.0, 0.9 * config.late, 1.1 * config.late, 1.1 * config.late):
        x0[0] += pause
        optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE)
    firsts, seconds = tried[::2], tried[1::2]
    # beside the perturbations: the nominal spline, a halt and the straight way
    varied = [np.any(first[1:-2] != first[0], axis=(0, 2)).tolist() for first in firsts]
    assert varied == [[True, True, True]] * 2 + [[True, True, False], [True, False, True]]
    assert [len(first) for first in firsts] == [3 + 18, 3 + 18, 3 + 12, 3 + 12]
    for first, second, knots in zip(firsts, seconds, varied, strict=True):
        moved = np.any(second != first[0], axis=(0, 2))
        assert not np.any(moved & ~np.array(knots)), "a knot that was not perturbed stays as it was"
