"""Following poses with more joints than six."""

import mujoco
import numpy as np

from pack_core.kinematics.chain import chain_from_model
from pack_core.kinematics.redundant_follower import RedundantFollower
from pack_core.packing.cell import packing_cell
from pack_core.robots.pump import add_pump

CELL = packing_cell()
ARM, HOME = CELL.robot.arm, np.array(CELL.robot.home)
SPEC = mujoco.MjSpec()
SPEC.compiler.degree = False
add_pump(ARM.add_to(SPEC), CELL.pump, ARM.flange)
CHAIN = chain_from_model(SPEC.compile(), ARM.joints, "tool")
FOLLOWER = RedundantFollower(CHAIN, ARM.limits.lower, ARM.limits.upper, HOME)


def test_joints_beyond_six_drift_home_while_the_tool_follows_its_poses() -> None:
    q, home = HOME + np.array([0.0, 0.0, 0.6, 0.0, 0.0, 0.0, 0.0]), HOME
    R_WT, p_WT = CHAIN.forward_matrix(q)
    apart = np.abs(q - home).max()
    for k in range(200):
        at = p_WT + 0.02 * np.sin(0.1 * k) * np.array([1.0, -1.0, 0.5])
        found = FOLLOWER.follow(R_WT, at, q)
        assert found is not None
        q = found
        R, p = CHAIN.forward_matrix(q)
        assert np.linalg.norm(p - at) < 1e-4
        assert np.abs(R - R_WT).max() < 1e-3
    assert np.abs(q - home).max() < 0.8 * apart


def test_a_pose_that_it_cannot_follow_is_told_before_the_tool_has_left_its_way() -> None:
    q = HOME
    R_WT, p_start = CHAIN.forward_matrix(q)
    for k in range(1000):
        at = p_start + np.array([0.003 * k, 0.0, 0.0])
        found = FOLLOWER.follow(R_WT, at, q)
        if found is None:
            break
        q = found
    assert 0.1 < CHAIN.forward_matrix(q)[1][0] - p_start[0] < 1.0
    assert np.linalg.norm(CHAIN.forward_matrix(q)[1] - at) < 0.01
