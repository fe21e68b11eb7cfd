"""The cross-entropy method of judo behind the interface of the optimizers."""

import sys

import numpy as np
import pytest

from pack_baselines.judo_optimizer import JudoConfig, JudoOptimizer
from pack_core.errors import PackError
from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.robots.panda import PANDA
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import load_weights
from pack_mpc.target import PackingTarget, Stage


def test_judo_that_is_not_installed_is_a_clear_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "judo.optimizers.cem", None)
    with pytest.raises(PackError, match=r"--no-deps -r requirements/judo\.txt"):
        JudoOptimizer.require()


def test_judos_method_lowers_the_cost_of_reaching_a_target() -> None:
    pytest.importorskip("judo", reason="judo is an extra: requirements/judo.txt")
    cell, weights = packing_cell(), load_weights("tuned")
    scene = cell.scene.model_copy(update={"objects": []})
    optimizer = JudoOptimizer(scene, cell, JudoConfig(), threads=1)
    still = np.zeros(7)
    joints = JointSample(0.0, np.array(cell.robot.home), still, still)
    held = SceneState(0.0, {scene.new_object.name: ObjectState(Pose(np.zeros(3), np.array([1.0, 0, 0, 0])))})
    x0 = optimizer.plant.state(joints, held)
    target = PackingTarget(optimizer.plant.held_position(x0) + np.array([0.05, 0.0, 0.0]), 0.0)
    residuals = Residuals(optimizer.plant, weights, target)
    cost = PackingCost(residuals, weights.of(Stage.PRE_PACK), weights.torque)
    costs = [optimizer.improve(x0, cost, Stage.PRE_PACK, target) for _ in range(8)]
    assert costs[-1].cost < 0.9 * costs[0].cost
    assert np.all(np.abs(costs[-1].setpoints.v) <= PANDA.limits.velocity)
    assert costs[-1].setpoints.q.shape == (JudoConfig().horizon, 7)
