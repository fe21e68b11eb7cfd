"""The KR 210's published kinematics and dynamics, in its model."""

import mujoco
import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.robots.kr210 import JERK_LIMITS, LIMITS, LINKS


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build_model(palletizing_cell())


def flange(model: mujoco.MjModel, q_deg: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Position in the base frame and direction of the flange's axis."""
    data = mujoco.MjData(model)
    data.qpos[:6] = np.deg2rad(q_deg)
    mujoco.mj_kinematics(model, data)
    body = data.body("flange")
    return body.xpos - np.array(palletizing_cell().arm.base), body.xmat.reshape(3, 3)[:, 2]


@pytest.mark.parametrize(
    ("q_deg", "p_BF", "axis"),
    [
        ([0, -90, 90, 0, 0, 0], (1.765, 0.0, 1.910), (1, 0, 0)),
        ([0, -90, 0, 0, 0, 0], (0.33 - 0.115, 0.0, 0.645 + 1.150 + 1.220 + 0.215), (0, 0, 1)),
        ([0, -90, 90, 0, 90, 0], (1.55, 0.0, 1.910 - 0.215), (0, 0, -1)),
        ([90, -90, 90, 0, 0, 0], (0.0, -1.765, 1.910), (0, -1, 0)),
        ([0, -90, 90, 90, 90, 0], (1.55, -0.215, 1.910), (0, -1, 0)),
    ],
)
def test_the_flange_is_where_the_published_frames_say(
    model: mujoco.MjModel, q_deg: list[float], p_BF: tuple[float, ...], axis: tuple[float, ...]
) -> None:
    p, z = flange(model, q_deg)
    np.testing.assert_allclose(p, p_BF, atol=1e-9)
    np.testing.assert_allclose(z, axis, atol=1e-9)


def test_the_wrist_centre_reaches_as_far_as_the_name_says() -> None:
    reach = LINKS[1].X_PJ.p[0] + np.hypot(LINKS[3].X_PJ.p[0], 1.220) + LINKS[2].X_PJ.p[0]
    assert reach == pytest.approx(2.705, abs=0.001)


def test_the_links_weigh_what_is_published(model: mujoco.MjModel) -> None:
    links = sum(float(model.body(f"kr210_link{i}").mass[0]) for i in range(1, 7))
    assert links == pytest.approx(1077.42 - 225.96, abs=0.01)


def test_gravity_near_stretch_takes_half_of_the_second_axis_effort(model: mujoco.MjModel) -> None:
    """4.2 kN m of 8.9 kN m for the bare arm; the tool of 12 kg adds 0.3."""
    data = mujoco.MjData(model)
    data.qpos[:6] = np.deg2rad([0, -5, 0, 0, 0, 0])
    mujoco.mj_forward(model, data)
    assert abs(data.qfrc_bias[1]) == pytest.approx(0.5 * LIMITS.effort[1], rel=0.02)


def test_speeds_are_the_published_ones() -> None:
    np.testing.assert_allclose(np.rad2deg(LIMITS.velocity), [117, 111, 112, 179, 172, 220], atol=0.5)


def test_joints_reach_full_acceleration_within_a_tenth_of_a_second() -> None:
    np.testing.assert_allclose(LIMITS.acceleration / JERK_LIMITS, 0.1)


def test_the_arm_at_home_points_its_pad_down_over_the_pallet(model: mujoco.MjModel) -> None:
    cell = palletizing_cell()
    data = mujoco.MjData(model)
    data.qpos[:6] = cell.arm.home
    mujoco.mj_kinematics(model, data)
    tool = data.body("tool")
    np.testing.assert_allclose(tool.xmat.reshape(3, 3)[:, 2], [0, 0, -1], atol=1e-3)
    lower, upper = cell.pallet.X_WP.p[:2], cell.pallet.X_WP.p[:2] + cell.pallet.size
    assert np.all((tool.xpos[:2] > lower) & (tool.xpos[:2] < upper))
