import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import arm_model
from pack_core.robots.ur10e import A2, A3, D1, D4, D5, D6, JOINTS, LIMITS, LINKS

MODEL = arm_model(blocks_cell())
TABLE = ((0, D1, np.pi / 2), (A2, 0, 0), (A3, 0, 0), (0, D4, np.pi / 2), (0, D5, -np.pi / 2), (0, D6, 0))


def by_the_table(q: np.ndarray) -> np.ndarray:
    """The flange in the base `(4, 4)`, as a product of Denavit-Hartenberg matrices."""
    T = np.eye(4)
    for (a, d, alpha), theta in zip(TABLE, q, strict=True):
        c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
        T = T @ [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    return T


@given(st.lists(st.floats(-3.1, 3.1), min_size=6, max_size=6).map(np.array))
def test_flange_is_where_the_denavit_hartenberg_table_puts_it(q: np.ndarray) -> None:
    data = mujoco.MjData(MODEL)
    for name, angle in zip(JOINTS, q, strict=True):
        data.joint(name).qpos = angle
    mujoco.mj_kinematics(MODEL, data)
    base, flange = data.body("ur10e_base"), data.body("flange")
    R_WB = base.xmat.reshape(3, 3)
    expected = by_the_table(q)
    assert R_WB.T @ (flange.xpos - base.xpos) == pytest.approx(expected[:3, 3], abs=1e-9)
    assert R_WB.T @ flange.xmat.reshape(3, 3) == pytest.approx(expected[:3, :3], abs=1e-9)


def test_links_weigh_what_the_manufacturer_says() -> None:
    assert sum(link.mass for link in LINKS) == pytest.approx(29.104)


def test_inertias_could_be_those_of_bodies() -> None:
    for link in LINKS:
        moments = np.linalg.eigvalsh(link.inertia)
        assert moments[0] > 0.0
        assert moments[2] <= moments[0] + moments[1] + 1e-4


def test_arm_can_hold_itself_and_a_block_stretched_out() -> None:
    data = mujoco.MjData(MODEL)
    for name, angle in zip(JOINTS, (0, 0, 0, -np.pi / 2, -np.pi / 2, 0), strict=True):
        data.joint(name).qpos = angle
    mujoco.mj_forward(MODEL, data)
    assert np.all(np.abs(data.qfrc_bias[:6]) < 0.6 * LIMITS.effort)
