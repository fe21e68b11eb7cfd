"""The controller's model and its derivatives."""

import mujoco
import numpy as np
import pytest

from pack_core.packing.cell import Tip, packing_cell
from pack_core.packing.model import HELD_POSITION, ArmRole
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, exp, multiply, normalize
from pack_core.states import ObjectState, SceneState
from pack_mpc.plant import STATE, PackingPlant


@pytest.fixture
def trajectory(plant: PackingPlant, joints, state) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    us = rng.normal(0.0, [4, 8, 4, 4, 1, 1, 1], (20, 7))
    xs, _ = plant.rollout(plant.state(joints, state), us[None])
    return xs[0], us


def test_a_rollout_is_what_stepping_gives(plant: PackingPlant, trajectory) -> None:
    xs, us = trajectory
    data = mujoco.MjData(plant.model)
    mujoco.mj_setState(plant.model, data, xs[0], STATE)
    for u in us:
        data.ctrl[:] = u
        mujoco.mj_step(plant.model, data)
    end = np.empty(plant.nx)
    mujoco.mj_getState(plant.model, data, end, STATE)
    np.testing.assert_allclose(xs[-1], end, atol=1e-9)


def test_derivatives_agree_with_central_differences(plant: PackingPlant, trajectory) -> None:
    xs, us = trajectory
    columns = plant.columns([])
    lin = plant.linearize(xs, us, columns, np.arange(len(xs)))
    t, h = 7, 1e-5
    for j, column in enumerate(columns):
        ends = [
            plant.rollout(xs[t] + s * h * np.eye(plant.nx)[column], us[None, t : t + 1])[0] for s in (1, -1)
        ]
        expected = (ends[0][0, 1, columns] - ends[1][0, 1, columns]) / (2 * h)
        np.testing.assert_allclose(lin.A[t, :, j], expected, atol=2e-4)


def test_derivatives_of_the_full_state_of_spinning_objects_are_those_that_mujoco_finds(
    plant: PackingPlant, joints, state
) -> None:
    rng, at, names = np.random.default_rng(0), plant.layout, plant.scene.names
    x0 = plant.state(joints, state)
    for height, name in enumerate(names, start=1):
        # in the air, as at rest on the base tiny steps of a pose switch contacts on and off
        x0[at.object_p[name][2]] += height
        x0[at.object_r[name][0] - 1 :][:4] = normalize(rng.normal(size=4))
        x0[at.object_w[name]] = rng.normal(0.0, 3.0, 3)
    us = rng.normal(0.0, 2.0, (1, 7))
    columns = plant.columns(names, turning=True)
    lin = plant.linearize(plant.rollout(x0, us[None])[0][0], us, columns, np.arange(2))

    nv, data = plant.model.nv, mujoco.MjData(plant.model)
    mujoco.mj_setState(plant.model, data, x0, STATE)
    data.ctrl[:] = us[0]
    A, B = np.empty((2 * nv, 2 * nv)), np.empty((2 * nv, plant.nu))
    mujoco.mjd_transitionFD(plant.model, data, 1e-6, True, A, B, None, None)
    freedoms = [(plant.model.joint(joint).dofadr[0], 1) for joint in plant.arm.joints]
    freedoms += [(plant.model.joint(name).dofadr[0], 6) for name in names]
    dofs = np.concatenate([first + np.arange(count) for first, count in freedoms])
    order = np.concatenate([dofs, nv + dofs])
    assert len(columns) == len(order) == 2 * (7 + 6 * len(names))
    np.testing.assert_allclose(lin.A[0], A[np.ix_(order, order)], atol=1e-5)
    np.testing.assert_allclose(lin.B[0], B[order], atol=1e-5)


def test_output_derivatives_are_the_jacobian_of_the_held_object(plant: PackingPlant, trajectory) -> None:
    xs, us = trajectory
    lin = plant.linearize(xs, us, plant.columns([]), np.arange(len(xs)))
    data = mujoco.MjData(plant.model)
    mujoco.mj_setState(plant.model, data, xs[5], STATE)
    mujoco.mj_forward(plant.model, data)
    jacobian = np.zeros((3, plant.model.nv))
    mujoco.mj_jacBody(plant.model, data, jacobian, None, plant.model.body(plant.scene.new_object.name).id)
    arm = plant.layout.v - 1 - plant.model.nq
    np.testing.assert_allclose(lin.C[5, plant.sensor(HELD_POSITION), :7], jacobian[:, arm], atol=1e-4)


def test_the_jacobian_of_the_held_object_agrees_with_central_differences(plant: PackingPlant, joints) -> None:
    data, body = mujoco.MjData(plant.model), plant.model.body(plant.scene.new_object.name).id
    J, h = plant.held_jacobian(joints.q), 1e-6

    def pose_at(q: Array) -> tuple[Array, Array]:
        data.qpos[plant.layout.q - 1] = q
        mujoco.mj_kinematics(plant.model, data)
        return data.xpos[body].copy(), data.xmat[body].reshape(3, 3).copy()

    for k, step in enumerate(h * np.eye(7)):
        (p_less, R_less), (p_more, R_more) = pose_at(joints.q - step), pose_at(joints.q + step)
        np.testing.assert_allclose(J[:3, k], (p_more - p_less) / (2 * h), atol=1e-6)
        # dR/dq R' is the cross product matrix of the angular velocity
        W = (R_more - R_less) / (2 * h) @ pose_at(joints.q)[1].T
        np.testing.assert_allclose(J[3:, k], [W[2, 1], W[0, 2], W[1, 0]], atol=1e-6)


def test_key_points_are_interpolated_linearly(plant: PackingPlant, trajectory) -> None:
    xs, us = trajectory
    coarse = plant.linearize(xs, us, plant.columns([]), np.array([0, 10, 20]))
    np.testing.assert_allclose(coarse.A[5], 0.5 * (coarse.A[0] + coarse.A[10]), atol=1e-12)


def test_state_keeps_joints_and_objects_where_they_belong(plant: PackingPlant, joints, state) -> None:
    x = plant.state(joints, state)
    np.testing.assert_array_equal(x[plant.layout.q], joints.q)
    for name, p in plant.layout.object_p.items():
        np.testing.assert_array_equal(x[p], state.objects[name].X_WO.p)


def test_a_plant_without_objects_has_only_the_arm(scene, joints, state) -> None:
    known = scene.model_copy(update={"objects": []})
    bare = PackingPlant(known, packing_cell(), timestep=0.006, threads=1)
    assert bare.nx == 1 + 7 + 7
    assert bare.state(joints, state).shape == (15,)


SOFT = Tip(lateral=6000.0, axial=8000.0, bending=15.0, twist=20.0, damping_time=0.006)


def hanging(scene: Scene, timestep: float = 0.012) -> PackingPlant:
    """A plant whose cup gives way."""
    cell = packing_cell().model_copy(update={"tip": SOFT})
    return PackingPlant(scene.description(), cell, timestep=timestep, threads=1, arm=ArmRole.SERVO)


def test_on_a_compliant_tip_the_object_is_where_it_is_seen(scene: Scene, joints, state) -> None:
    compliant = hanging(scene)
    name = scene.new_object.name
    rigid = state.objects[name].X_WO
    seen = Pose(
        rigid.p + np.array([0.002, -0.001, 0.0005]), multiply(exp(np.array([0.06, -0.04, 0.02])), rigid.q)
    )
    objects = {**state.objects, name: ObjectState(seen, np.zeros(3), np.zeros(3))}
    x = compliant.state(joints, SceneState(state.time, objects))
    np.testing.assert_allclose(compliant.held_position(x), seen.p, atol=1e-9)


@pytest.mark.parametrize("timestep", [0.006, 0.012, 0.025])
def test_what_hangs_still_stays_so_and_what_is_bent_springs_back(
    scene: Scene, joints, state, timestep: float
) -> None:
    compliant = hanging(scene, timestep)
    x = compliant.state(joints, state)
    hold = np.tile(np.concatenate([joints.q, np.zeros(7)]), (1, round(0.5 / timestep), 1))
    at_rest = compliant.held_position(compliant.rollout(x, hold)[0][0, -1])
    np.testing.assert_allclose(at_rest, compliant.held_position(x), atol=5e-4)
    tip = 1 + compliant.model.joint("tip_roll").qposadr[0]
    bent = x.copy()
    bent[tip] = 0.1
    xs = compliant.rollout(bent, hold)[0][0]
    assert np.abs(xs[:, tip]).max() <= 0.1 + 1e-9
    assert abs(xs[-1, tip]) < 0.01


def test_a_tip_gives_way_by_force_over_stiffness(scene: Scene, joints, state) -> None:
    compliant = hanging(scene)
    data = mujoco.MjData(compliant.model)
    mujoco.mj_setState(compliant.model, data, compliant.state(joints, state), STATE)
    data.ctrl[:] = np.concatenate([joints.q, np.zeros(7)])
    tip = compliant.model.joint("tip_roll")
    data.qfrc_applied[tip.dofadr[0]] = 0.6
    for _ in range(100):
        mujoco.mj_step(compliant.model, data)
    assert data.qpos[tip.qposadr[0]] == pytest.approx(0.6 / SOFT.bending, rel=0.05)
