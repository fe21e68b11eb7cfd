"""The controller as a whole, with each optimizer."""

from dataclasses import replace

import numpy as np
import pytest

from pack_core.config import validate_config
from pack_core.errors import ConfigError, PackError
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.robots.panda import PANDA
from pack_core.states import SceneState
from pack_mpc.controller import ControllerConfig, PackingController
from pack_mpc.cost.weights import load_weights
from pack_mpc.optimizers import OPTIMIZERS
from pack_mpc.optimizers.optimizer import Optimizer
from pack_mpc.state_reduction import StateReductionConfig
from pack_mpc.target import PackingTarget, Stage

ABOVE = PackingTarget(np.array([0.45, 0.05, 0.30]), 0.2)
INSIDE = PackingTarget(np.array([0.50, 0.02, 0.09]), 0.0, collisions=("tea_box",))


def build(scene: Scene, optimizer: str, threads: int = 2) -> PackingController:
    config = ControllerConfig(optimizer=optimizer, threads=threads)
    return PackingController(scene.description(), packing_cell(), load_weights("tuned"), config)


@pytest.fixture(params=OPTIMIZERS)
def optimizer(request: pytest.FixtureRequest) -> str:
    """The name of each registered optimizer that is installed."""
    try:
        OPTIMIZERS[request.param].require()
    except PackError as error:
        pytest.skip(str(error))
    return str(request.param)


@pytest.mark.parametrize("optimizer", ["ilqr", "sgn"])
def test_plans_bring_the_held_object_towards_its_target(scene, optimizer, joints, state) -> None:
    controller = build(scene, optimizer)
    plan = [controller.plan(joints, state, Stage.PRE_PACK, ABOVE, 0.0, 0.0) for _ in range(3)][-1]
    path = plan.solution.p_WN
    assert np.linalg.norm(path[-1] - ABOVE.p_WN) < 0.5 * np.linalg.norm(path[0] - ABOVE.p_WN)


def test_setpoints_respect_every_limit_and_start_when_they_are_in_force(
    scene, optimizer, joints, state
) -> None:
    controller = build(scene, optimizer)
    setpoints = controller.plan(joints, state, Stage.INSERT, INSIDE, 0.0, 0.048).setpoints
    assert setpoints.time == pytest.approx(0.048)
    assert np.all((setpoints.q >= PANDA.limits.lower) & (setpoints.q <= PANDA.limits.upper))
    assert np.all(np.abs(setpoints.v) <= PANDA.limits.velocity)
    assert np.all(np.abs(setpoints.tau) <= PANDA.limits.effort)
    assert setpoints.offsets[-1] == pytest.approx(ControllerConfig().published, abs=0.013)


def test_same_measurements_same_plan_whatever_the_threads(scene, joints, state, optimizer) -> None:
    plans = []
    for threads in (1, 2):
        controller = build(scene, optimizer, threads)
        for _ in range(3):
            plan = controller.plan(joints, state, Stage.INSERT, INSIDE, 0.0, 0.0)
        plans.append(plan)
    np.testing.assert_array_equal(plans[0].setpoints.q, plans[1].setpoints.q)
    np.testing.assert_array_equal(plans[0].setpoints.tau, plans[1].setpoints.tau)


def test_uninformed_physics_does_not_know_the_objects(scene: Scene, joints) -> None:
    controller = build(scene.model_copy(update={"objects": []}), "ilqr")
    plan = controller.plan(joints, SceneState(0.0, {}), Stage.INSERT, INSIDE, 0.0, 0.0)
    assert np.isfinite(plan.solution.cost)


def test_obstacles_repel_no_more_once_eq_3_has_run_out(scene: Scene, joints, state) -> None:
    away = replace(INSIDE, collisions=())
    end = load_weights("tuned").obstacle_decay
    late, free = (
        build(scene, "ilqr").plan(joints, state, Stage.INSERT, target, end, 0.0).solution
        for target in (INSIDE, away)
    )
    early = build(scene, "ilqr").plan(joints, state, Stage.INSERT, INSIDE, 0.5 * end, 0.0).solution
    assert late.cost == pytest.approx(free.cost)
    assert early.cost > late.cost


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_a_registered_optimizer_has_a_section_of_parameters(name: str) -> None:
    cls = OPTIMIZERS[name]
    assert issubclass(cls, Optimizer)
    own = getattr(ControllerConfig(optimizer=name), name)
    assert isinstance(own, cls.parameters)
    assert isinstance(own.reduction, StateReductionConfig)


def test_an_unknown_optimizer_is_refused_with_those_that_exist() -> None:
    def configure(name: str) -> None:
        validate_config(ControllerConfig, {"optimizer": name}, "")

    for choose in (OPTIMIZERS.__getitem__, configure):
        with pytest.raises(ConfigError, match="'magic'; allowed: sgn, ilqr, judo"):
            choose("magic")


def test_a_misspelt_parameter_of_an_optimizer_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"'sgn\.knobs' is not known"):
        validate_config(ControllerConfig, {"sgn": {"knobs": 3}}, "mpc.yaml")
