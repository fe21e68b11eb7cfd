"""Predicted states with feed-forward torques exert the torque of the servos that pull at the reference."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_mpc.cost.cost import PackingCost, Residuals
from pack_mpc.cost.weights import load_weights
from pack_mpc.optimizers.optimizer import Solution
from pack_mpc.optimizers.sgn import SgnConfig, SgnOptimizer
from pack_mpc.optimizers.spline import predicted_setpoints
from pack_mpc.target import PackingTarget, Stage
from unit.pack_sim.packing.driver import Driver

DRIVE = packing_cell().robot
OFFSETS = np.array([0.0, 0.02, 0.05, 0.07])


def rows_near(drive_home: Array, rng: np.random.Generator, spread: float) -> Array:
    return np.asarray(drive_home + spread * rng.uniform(-1.0, 1.0, (len(OFFSETS), 7)))


@given(seed=st.integers(0, 10_000), time=st.floats(1.0, 1.07))
def test_the_drivers_torque_is_that_of_the_servos_at_every_moment(scene: Scene, plant, seed, time) -> None:
    rng = np.random.default_rng(seed)
    home = np.array(DRIVE.home)
    # leads small enough for torques and speeds to stay within their limits, where nothing is clipped
    q_des, q_pred = rows_near(home, rng, 0.05), rows_near(home, rng, 0.05)
    # 100 N m/rad * 0.1 rad + 20 N m s/rad * 0.08 rad/s are below the 12 N m of the fifth joint
    v_des, v_pred = rows_near(np.zeros(7), rng, 0.04), rows_near(np.zeros(7), rng, 0.04)
    xs = np.zeros((len(OFFSETS), plant.nx))
    xs[:, 0] = 1.0 + OFFSETS
    xs[:, plant.layout.q], xs[:, plant.layout.v] = q_pred, v_pred
    driver = Driver(DRIVE, watchdog=1.0)
    driver.accept(predicted_setpoints(plant, DRIVE, OFFSETS, xs, q_des, v_des), 1.0)
    q, v = home + 0.02 * rng.normal(size=7), 0.02 * rng.normal(size=7)
    q_d, v_d = (
        np.array([np.interp(time - 1.0, OFFSETS, column) for column in rows.T]) for rows in (q_des, v_des)
    )
    servos = np.array(DRIVE.stiffness) * (q_d - q) + np.array(DRIVE.damping) * (v_d - v)
    limits = DRIVE.arm.limits.effort
    expected = np.clip(servos, -limits, limits)
    np.testing.assert_allclose(driver.torque(time, q, v, lambda: np.eye(7)), expected, atol=1e-9)


def pressing(scene: Scene, joints: JointSample, state: SceneState) -> tuple[SgnOptimizer, Solution]:
    """A plan whose target is half a metre down, through the container and the table."""
    optimizer = SgnOptimizer(scene.description(), packing_cell(), SgnConfig(), threads=1)
    target = PackingTarget(np.array([0.5, 0.0, -0.4]), 0.0)
    weights = load_weights("tuned")
    cost = PackingCost(
        Residuals(optimizer.plant, weights, target), weights.of(Stage.PRE_PACK), weights.torque
    )
    x0 = optimizer.plant.state(joints, state)
    for _ in range(3):
        solution = optimizer.improve(x0, cost, Stage.PRE_PACK, target)
    return optimizer, solution


def test_the_plan_states_predicted_states_of_its_model(scene, joints, state) -> None:
    optimizer, solution = pressing(scene, joints, state)
    plan = solution.setpoints
    x0 = optimizer.plant.state(joints, state)
    np.testing.assert_array_equal(plan.q[0], x0[optimizer.plant.layout.q])
    np.testing.assert_array_equal(plan.v[0], x0[optimizer.plant.layout.v])
    # a velocity is how the position goes on, which a reference that leads the arm would not be
    moved = np.diff(plan.q, axis=0) / np.diff(plan.offsets)[:, None]
    fastest = DRIVE.arm.limits.velocity
    np.testing.assert_allclose(np.clip(moved, -fastest, fastest), plan.v[1:], atol=1e-6)


def test_without_its_torque_a_plan_does_not_set_the_arm_going(scene, joints, state) -> None:
    _, solution = pressing(scene, joints, state)
    plan, limits = solution.setpoints, DRIVE.arm.limits
    assert np.abs(plan.tau).max() > 5.0
    assert np.all(np.abs(plan.tau) <= limits.effort)
    driver = Driver(DRIVE, watchdog=1.0)
    driver.accept(plan, plan.time)
    at_rest = driver.torque(plan.time, joints.q, joints.v, lambda: np.eye(7))
    np.testing.assert_allclose(at_rest, np.clip(plan.tau[0], -limits.effort, limits.effort), atol=1e-9)


@pytest.mark.parametrize("share", [1.0, 0.5, 0.125])
def test_the_driver_feeds_back_the_configured_share_and_holds_with_all(share: float) -> None:
    drive = DRIVE.model_copy(update={"feedback": share})
    driver = Driver(drive, watchdog=0.1)
    home, still = np.array(DRIVE.home), np.zeros(7)
    off = home + 0.01
    held = driver.torque(0.0, home, still, lambda: np.eye(7))
    np.testing.assert_array_equal(held, still)
    np.testing.assert_allclose(
        driver.torque(0.0, off, still, lambda: np.eye(7)), -0.01 * np.array(DRIVE.stiffness)
    )
    plan = predicted_rest(home)
    driver.accept(plan, 0.0)
    followed = driver.torque(0.0, off, still, lambda: np.eye(7))
    np.testing.assert_allclose(followed, -0.01 * share * np.array(DRIVE.stiffness))


def predicted_rest(q: Array) -> Setpoints:
    zero = np.zeros((2, 7))
    return Setpoints(0.0, np.array([0.0, 1.0]), np.tile(q, (2, 1)), zero, zero)
