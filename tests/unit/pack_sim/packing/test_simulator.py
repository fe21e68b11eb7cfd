"""The simulated cell as a robot driver."""

import mujoco
import numpy as np
import pytest

from pack_core.joints import Setpoints
from pack_core.packing.cell import PackingCell, Suction, packing_cell
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, angle_between
from pack_sim.packing.simulator import Simulator, SimulatorConfig

SPOTS = {
    "soup_can": (0.42, 0.05), "coffee_tin": (0.58, 0.05), "tea_box": (0.50, 0.05),
    "cracker_box": (0.43, -0.06), "sugar_box": (0.57, -0.05),
}  # fmt: skip


@pytest.fixture(scope="module")
def scene() -> Scene:
    scene = packing_cell().scene
    return scene.with_poses(
        {item.name: Pose(np.array([*SPOTS[item.name], item.half_extents[2]])) for item in scene.objects}
    )


def build(scene: Scene, cell: PackingCell | None = None, seed: int = 0) -> Simulator:
    return Simulator(cell or packing_cell(), scene, SimulatorConfig(), np.random.default_rng(seed))


def run(simulator: Simulator, duration: float) -> None:
    for _ in range(round(duration / simulator.config.timestep)):
        simulator.step()


def test_the_arm_stays_where_it_is_without_setpoints(scene: Scene) -> None:
    simulator = build(scene)
    run(simulator, 0.5)
    np.testing.assert_allclose(simulator.joints().q, packing_cell().robot.home, atol=1e-4)


def test_a_hanging_object_exerts_no_external_force(scene: Scene) -> None:
    simulator = build(scene)
    run(simulator, 0.3)
    force, torque = simulator.external_wrench()
    np.testing.assert_allclose(np.concatenate([force, torque]), 0.0, atol=0.05)


def test_the_held_object_hangs_upright_from_the_cup(scene: Scene) -> None:
    held = build(scene).truth().objects[scene.new_object.name].X_WO
    np.testing.assert_allclose(held.p, [0.5, 0.0, 0.36], atol=1e-3)
    assert angle_between(held.q, [1, 0, 0, 0]) < 1e-3


def test_the_arm_follows_its_setpoints(scene: Scene) -> None:
    simulator = build(scene)
    goal = simulator.joints().q + np.array([0.1, 0, 0, 0, 0, 0, 0.2])
    for _ in range(80):
        plan = Setpoints(
            simulator.time, np.array([0.0, 1.0]), np.tile(goal, (2, 1)), *2 * (np.zeros((2, 7)),)
        )
        simulator.accept(plan)
        run(simulator, 0.05)
    np.testing.assert_allclose(simulator.joints().q, goal, atol=2e-3)


@pytest.mark.parametrize("joint", range(7))
def test_a_fast_arm_without_setpoints_is_at_rest_within_40_ms(scene: Scene, joint: int) -> None:
    simulator = build(scene)
    plan = Setpoints(simulator.time, np.linspace(0.0, 1.0, 40), *(np.zeros((40, 7)) for _ in range(3)))
    plan.q[:] = simulator.joints().q
    plan.q[:, joint] -= plan.offsets
    plan.v[:, joint] = -1.0
    for _ in range(6):
        simulator.accept(plan)
        run(simulator, 0.05)
    assert np.abs(simulator.joints().v).max() > 0.9
    simulator.follower.drop()
    run(simulator, 0.04)
    for _ in range(100):
        run(simulator, 0.002)
        assert np.abs(simulator.joints().v).max() < 0.02


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_stop_for_want_of_the_next_setpoints_is_gentle_to_the_held_object(
    scene: Scene, direction: tuple[float, ...]
) -> None:
    simulator = build(scene)
    run(simulator, 0.2)
    lead(simulator, 0.3 * np.array(direction), 0.35)
    before = simulator.data.body("tool").xpos.copy()
    forces = []
    for _ in range(200):
        simulator.step()
        forces.append(np.linalg.norm(simulator.external_wrench()[0]))
    assert max(forces) < 9.0  # 14 and 17 N with the time constant of the other stops
    assert np.abs(simulator.joints().v).max() < 0.01
    assert np.linalg.norm(simulator.data.body("tool").xpos - before) < 0.007


def lead(simulator: Simulator, v_WC: np.ndarray, duration: float) -> None:
    """Move the cup from rest with `v_WC` `(3,)` [m/s] after 0.1 s, for `duration` [s]."""
    model, data, joints = simulator.model, simulator.data, packing_cell().robot.arm.joints
    J = np.zeros((6, model.nv))
    mujoco.mj_jacBody(model, data, J[:3], J[3:], model.body("tool").id)
    rates = np.linalg.pinv(J[:, [model.joint(name).dofadr[0] for name in joints]])[:, :3] @ v_WC
    start, q = simulator.time, simulator.joints().q
    while simulator.time - start < duration:
        offsets = simulator.time - start + np.array([0.0, 0.006])
        way = np.where(offsets < 0.1, 5.0 * offsets**2, offsets - 0.05)
        v = np.minimum(offsets / 0.1, 1.0)[:, None] * rates
        plan = Setpoints(
            simulator.time, np.array([0.0, 0.006]), q + way[:, None] * rates, v, np.zeros((2, 7))
        )
        simulator.accept(plan)
        run(simulator, 0.005)


def test_an_object_that_is_let_go_falls_and_the_arm_carries_on(scene: Scene) -> None:
    simulator = build(scene)
    run(simulator, 0.1)
    q = simulator.joints().q
    simulator.release()
    run(simulator, 0.1)
    fallen = simulator.truth().objects[scene.new_object.name].X_WO.p[2]
    assert fallen == pytest.approx(0.36 - 0.5 * 9.81 * 0.1**2, abs=0.002)
    np.testing.assert_allclose(simulator.joints().q, q, atol=5e-3)
    assert not simulator.pump.state.is_closed


def test_letting_go_leaves_the_other_objects_alone(scene: Scene) -> None:
    simulator = build(scene)
    run(simulator, 0.2)
    before = simulator.truth().poses()
    simulator.release()
    after = simulator.truth().poses()
    for name in before:
        np.testing.assert_allclose(before[name].p, after[name].p, atol=1e-9)


def test_gripping_needs_the_object_under_the_cup(scene: Scene) -> None:
    simulator = build(scene)
    simulator.release()
    assert simulator.grip() == ""
    assert simulator.pump.state.is_closed
    simulator.release()
    run(simulator, 0.15)
    assert "allowed: 5 mm" in simulator.grip()
    assert not simulator.pump.state.is_closed


def test_a_pump_that_is_pulled_too_hard_lets_go_and_says_why(scene: Scene) -> None:
    weak = packing_cell().model_copy(update={"suction": Suction(pull=4.0, shear=100.0, moment=100.0)})
    simulator = build(scene, weak)
    run(simulator, 0.1)
    assert "pull" in simulator.pump.state.release_reason
    assert "above 4.0 N" in simulator.pump.state.release_reason


def test_same_seed_same_run(scene: Scene) -> None:
    first, second = build(scene, seed=3), build(scene, seed=3)
    for simulator in (first, second):
        run(simulator, 0.2)
    np.testing.assert_array_equal(first.data.qpos, second.data.qpos)
    frames = [simulator.mocap.due(simulator.time)[-1].p_WM for simulator in (first, second)]
    np.testing.assert_array_equal(*frames)
