from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.errors import PackError
from pack_core.kinematics.chain import SerialChain, chain_from_model
from pack_core.robots import kr210, ur10e
from pack_core.rotations import Array, Pose, angle_between, log, multiply

angles = st.lists(st.floats(-2.5, 2.5), min_size=6, max_size=6).map(np.array)
H = 1e-6


def difference(A: Pose, B: Pose) -> Array:
    """Twist `(6,)` from A to B in world axes."""
    return np.concatenate([B.p - A.p, log(multiply(B.q, A.q * np.array([1, -1, -1, -1])))])


@given(q=angles)
@settings(max_examples=30)
def test_forward_kinematics_are_those_of_the_model(
    kr210_chain: SerialChain, kr210_model: mujoco.MjModel, q: Array
) -> None:
    data = mujoco.MjData(kr210_model)
    data.qpos[:] = q
    mujoco.mj_kinematics(kr210_model, data)
    X_WT = kr210_chain.forward(q)
    np.testing.assert_allclose(X_WT.p, data.body("tool").xpos, atol=1e-9)
    assert angle_between(X_WT.q, data.body("tool").xquat) < 1e-7


@pytest.mark.parametrize(("robot", "joints"), [("kr210", kr210.JOINTS), ("ur10e", ur10e.JOINTS)])
def test_the_chain_read_from_a_model_is_the_one_from_the_table(
    robot: str, joints: tuple[str, ...], request: pytest.FixtureRequest
) -> None:
    chain: SerialChain = request.getfixturevalue(f"{robot}_chain")
    read = chain_from_model(request.getfixturevalue(f"{robot}_model"), joints, "tool")
    q = np.array([0.3, -1.1, 0.7, 0.2, -0.4, 1.9])
    np.testing.assert_allclose(read.forward(q).p, chain.forward(q).p, atol=1e-9)
    np.testing.assert_allclose(read.jacobian(q), chain.jacobian(q), atol=1e-9)


@given(q=angles, v=angles)
@settings(max_examples=30)
def test_jacobian_is_the_derivative_of_the_pose(kr210_chain: SerialChain, q: Array, v: Array) -> None:
    moved = difference(kr210_chain.forward(q - H * v), kr210_chain.forward(q + H * v)) / (2 * H)
    np.testing.assert_allclose(kr210_chain.jacobian(q) @ v, moved, atol=1e-6)


@given(q=angles, v=angles)
@settings(max_examples=30)
def test_bias_is_the_derivative_of_the_jacobian(ur10e_chain: SerialChain, q: Array, v: Array) -> None:
    Jdot = (ur10e_chain.jacobian(q + H * v) - ur10e_chain.jacobian(q - H * v)) / (2 * H)
    np.testing.assert_allclose(ur10e_chain.bias(q, v), Jdot @ v, atol=1e-6)


def test_a_tool_frame_is_added_at_the_tool(kr210_chain: SerialChain) -> None:
    X_TN, q = Pose(np.array([0.1, 0.2, 0.3])), np.array([0.1, -1.0, 1.2, 0.3, 0.4, 0.5])
    np.testing.assert_allclose(kr210_chain.with_tool(X_TN).forward(q).p, (kr210_chain.forward(q) @ X_TN).p)


def test_a_joint_that_does_not_carry_the_tool_is_refused(kr210_model: mujoco.MjModel) -> None:
    with pytest.raises(PackError, match="joint_a6"):
        chain_from_model(kr210_model, kr210.JOINTS, "kr210_link5")
