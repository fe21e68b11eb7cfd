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
from pack_mpc.optimizers.sgn import SPARING, SgnConfig, SgnOptimizer
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


def test_every_parameter_is_perturbed_unless_sparing_and_then_each_in_turn(
    optimizer, x0, monkeypatch
) -> None:
    tried = []
    roll_out = optimizer._roll_out
    monkeypatch.setattr(optimizer, "_roll_out", lambda *args: tried.append(args[-1]) or roll_out(*args))
    cost = cost_of(optimizer, ABOVE)
    for is_sparing in (False, False, *[True] * SPARING):
        optimizer.is_sparing = is_sparing
        optimizer.improve(x0, cost, Stage.PRE_PACK, ABOVE)
        x0[0] += 0.048  # so that no perturbation changes nothing
    firsts, seconds = tried[::2], tried[1::2]
    assert [len(first) for first in firsts[:2]] == [1 + 18 + 2] * 2, "and a halt and the straight way"
    assert sum(len(first) - 1 for first in firsts[2:]) == 18 + 2
    ways = [first[1 : 1 + 18 // SPARING] != first[0] for first in firsts[2:]]
    assert (np.sum(ways, axis=(0, 1)) == 1).all(), "once each"
    moved = np.any(seconds[-1] != firsts[-1][0], axis=0)
    assert np.any(moved & ~ways[-1].any(axis=0)), "what another parameter does is known from before"


def test_no_difference_outlasts_the_stage_or_the_collision_list(optimizer, x0, monkeypatch) -> None:
    tried, optimizer.is_sparing = [], True
    roll_out = optimizer._roll_out
    monkeypatch.setattr(optimizer, "_roll_out", lambda *args: tried.append(args[-1]) or roll_out(*args))
    free = PackingTarget(BELOW, 0.0)
    crowded = PackingTarget(BELOW, 0.0, collisions=(optimizer.plant.scene.objects[0].name,))
    steps = ((Stage.PRE_PACK, free), (Stage.INSERT, free), (Stage.INSERT, crowded), (Stage.INSERT, crowded))
    for stage, target in steps:
        optimizer.improve(x0, cost_of(optimizer, target, stage), stage, target)
    sizes = [len(first) for first in tried[::2]]
    assert sizes[:3] == [1 + 18 + 2] * 3
    assert sizes[3] <= 1 + 18 // SPARING + 1
