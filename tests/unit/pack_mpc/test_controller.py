"""The controller as a whole."""

import numpy as np
import pytest
from pack_core.cells.packing import packing_cell
from pack_core.robots.panda import LOWER, TORQUE_LIMITS, UPPER, VELOCITY_LIMITS
from pack_core.scene.state import ObjectState, SceneState
from pack_mpc.controller import ControllerConfig, PackingController
from pack_mpc.residuals import Target
from pack_mpc.weights import Stage, load_weights

ABOVE = Target(np.array([0.45, 0.05, 0.30]), 0.2)
INSIDE = Target(np.array([0.50, 0.02, 0.09]), 0.0, ("tea_box",))


@pytest.fixture
def controller(scene) -> PackingController:
    return PackingController(scene.description(), packing_cell(), load_weights("tuned"), ControllerConfig())


def test_plans_bring_the_held_object_towards_its_target(controller, joints, state) -> None:
    plan = [controller.plan(joints, state, Stage.PRE_PACK, ABOVE, 0.0, 0.0) for _ in range(3)][-1]
    path = controller.held_position(plan.trajectory)
    assert np.linalg.norm(path[-1] - ABOVE.p_WN) < 0.5 * np.linalg.norm(path[0] - ABOVE.p_WN)


def test_setpoints_respect_every_limit_and_start_when_they_are_in_force(controller, joints, state) -> None:
    plan = controller.plan(joints, state, Stage.INSERT, INSIDE, 0.0, 0.048)
    setpoints = plan.setpoints
    assert setpoints.time == pytest.approx(0.048)
    assert np.all((LOWER <= setpoints.q) & (setpoints.q <= UPPER))
    assert np.all(np.abs(setpoints.v) <= VELOCITY_LIMITS)
    assert np.all(np.abs(setpoints.tau) <= TORQUE_LIMITS)


def test_same_measurements_same_plan_whatever_the_threads(scene, joints, state) -> None:
    plans = []
    for threads in (1, 2):
        config = ControllerConfig(threads=threads)
        controller = PackingController(scene.description(), packing_cell(), load_weights("tuned"), config)
        for _ in range(3):
            plan = controller.plan(joints, state, Stage.INSERT, INSIDE, 0.0, 0.0)
        plans.append(plan)
    np.testing.assert_array_equal(plans[0].setpoints.tau, plans[1].setpoints.tau)


def test_a_plan_that_diverges_is_replaced_by_gravity_compensation(controller, joints, state) -> None:
    plan = controller.plan(joints, state, Stage.PRE_PACK, ABOVE, 0.0, 0.0)
    plan.trajectory.us[:] = TORQUE_LIMITS
    plan = controller.plan(joints, state, Stage.PRE_PACK, ABOVE, 0.0, 0.0)
    assert "started afresh" in plan.warning
    assert np.abs(plan.setpoints.v).max() < 5.0


def test_uninformed_physics_does_not_know_the_objects(scene, joints) -> None:
    controller = PackingController(
        scene.description(), packing_cell(), load_weights("tuned"), ControllerConfig(), with_objects=False
    )
    plan = controller.plan(joints, SceneState(0.0, {}), Stage.INSERT, INSIDE, 0.0, 0.0)
    assert np.isfinite(plan.cost)


def test_only_objects_that_are_pushed_are_in_the_state(controller, scene, joints, state) -> None:
    far = {name: ObjectState(item.X_WO) for name, item in state.objects.items()}
    plan = controller.plan(joints, SceneState(0.0, far), Stage.PRE_PACK, ABOVE, 0.0, 0.0)
    assert controller.touched(plan.trajectory) == []
