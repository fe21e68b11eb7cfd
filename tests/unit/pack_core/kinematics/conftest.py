"""Both arms, as chains from their tables and as MuJoCo models."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pack_core.kinematics.chain import SerialChain
from pack_core.robots import kr210, ur10e
from pack_core.rotations import Pose, from_rpy

X_WB = Pose(np.array([-1.5, 1.2, 0.3]), from_rpy((0.0, 0.0, 0.4)))
X_FT = Pose(np.array([0.01, -0.02, 0.25]), from_rpy((0.1, -0.2, 0.3)))


@pytest.fixture(scope="session")
def kr210_chain() -> SerialChain:
    return SerialChain.from_joints(X_WB, (link.X_PJ for link in kr210.LINKS), kr210.X_6F @ X_FT)


@pytest.fixture(scope="session")
def ur10e_chain() -> SerialChain:
    return SerialChain.from_joints(X_WB, (link.X_PJ for link in ur10e.LINKS), ur10e.X_6F @ X_FT)


@pytest.fixture(scope="session")
def kr210_model() -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    flange = kr210.add_kr210(spec, X_WB, visuals=False)
    _add_tool(flange)
    return spec.compile()


@pytest.fixture(scope="session")
def ur10e_model() -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    flange = ur10e.add_ur10e(spec, X_WB, contype=0, conaffinity=0)
    _add_tool(flange)
    return spec.compile()


def _add_tool(flange: mujoco.MjsBody) -> None:
    tool = flange.add_body(name="tool", pos=X_FT.p, quat=X_FT.q)
    tool.mass, tool.inertia, tool.explicitinertial = 1.0, (0.01, 0.01, 0.01), True
