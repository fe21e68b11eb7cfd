"""The arms that can pack: their published lengths, limits and weights, and how a cell names one."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pack_core.errors import ConfigError, MessageError
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.paths import project_root
from pack_core.robots.iiwa14 import IIWA14
from pack_core.robots.packing_arms import PACKING_ARMS, arm_of
from pack_core.robots.panda import PANDA
from pack_core.robots.seven_axis_arm import SevenAxisArm

ARMS = PACKING_ARMS.values()


def posed(arm: SevenAxisArm, q: np.ndarray) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The arm alone, at joint positions `q`."""
    spec = mujoco.MjSpec()
    arm.add_to(spec).add_site(name="flange", pos=(0.0, 0.0, arm.flange))
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    return model, data


@pytest.mark.parametrize(
    ("arm", "height", "mass"), [(PANDA, 0.333 + 0.316 + 0.384 - 0.107, 16.06), (IIWA14, 1.306, 25.61)]
)
def test_the_stretched_arm_is_as_tall_and_heavy_as_published(
    arm: SevenAxisArm, height: float, mass: float
) -> None:
    model, data = posed(arm, np.zeros(7))
    assert data.site("flange").xpos[2] == pytest.approx(height, abs=1e-9)
    assert model.body_mass.sum() == pytest.approx(mass, abs=0.01)


def test_a_bent_iiwa_has_its_flange_where_plane_geometry_puts_it() -> None:
    """Shoulder 0.36, upper arm 0.42, forearm 0.40, wrist to flange 0.126 [m], all in the x-z plane."""
    q2, q4, q6 = 0.5, -1.1, 0.9
    _, data = posed(IIWA14, np.array([0.0, q2, 0.0, q4, 0.0, q6, 0.0]))
    angles = np.array([q2, q2 - q4, q2 - q4 + q6])  # of the three parts off the vertical
    lengths = np.array([0.42, 0.40, 0.126])
    expected = [lengths @ np.sin(angles), 0.0, 0.36 + lengths @ np.cos(angles)]
    np.testing.assert_allclose(data.site("flange").xpos, expected, atol=1e-9)


@pytest.mark.parametrize(("arm", "angle"), [(PANDA, -0.467), (IIWA14, 0.0)])
def test_the_straight_arm_has_its_wrist_farthest_from_the_shoulder(arm: SevenAxisArm, angle: float) -> None:
    q4 = np.linspace(arm.limits.lower[3], arm.limits.upper[3], 3001)
    farthest = q4[np.argmax([reach(arm, at) for at in q4])]
    assert arm.straight == pytest.approx(farthest, abs=1e-3)
    assert arm.straight == pytest.approx(angle, abs=1e-3)


def reach(arm: SevenAxisArm, q4: float) -> float:
    """From the origin of link 2, the shoulder, to that of link 6, the wrist [m]."""
    model, data = posed(arm, np.array([0.0, 0.0, 0.0, q4, 0.0, 0.0, 0.0]))
    shoulder, wrist = (data.xpos[model.body(f"{arm.name}_link{i}").id] for i in (2, 6))
    return float(np.linalg.norm(wrist - shoulder))


@pytest.mark.parametrize("name", PACKING_ARMS)
def test_the_elbow_stays_bent_to_the_side_of_the_home_pose(name: str) -> None:
    drive = packing_cell().with_arm(name).robot
    straight = drive.arm.straight
    lower, upper = drive.bent
    assert lower[3] < drive.home[3] < upper[3] < straight
    other = drive.model_copy(update={"home": (*drive.home[:3], straight + 0.3, *drive.home[4:])})
    assert other.bent[0][3] == pytest.approx(straight + 0.25)
    for bent, limits in zip(drive.bent, (drive.arm.limits.lower, drive.arm.limits.upper), strict=True):
        np.testing.assert_allclose(np.delete(bent, 3), np.delete(limits, 3))


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm.name)
def test_an_arm_in_the_cell_has_the_joints_and_limits_of_its_data(arm: SevenAxisArm) -> None:
    cell = packing_cell().with_arm(arm.name)
    model = build_model(
        cell.scene.description(), cell, timestep=0.002, arm=ArmRole.DRIVEN, held=HeldRole.RIGID
    )
    assert [model.joint(i).name for i in range(model.njnt) if model.joint(i).name in arm.joints] == [
        *arm.joints
    ]
    np.testing.assert_allclose(model.actuator_ctrlrange[:, 1], arm.limits.effort)
    for i, name in enumerate(arm.joints):
        np.testing.assert_allclose(model.joint(name).range, (arm.limits.lower[i], arm.limits.upper[i]))


def test_an_arm_of_six_axes_is_refused() -> None:
    with pytest.raises(ValueError, match="'short' has 6 links"):
        replace(IIWA14, name="short", links=IIWA14.links[:6])


def test_an_arm_is_known_by_its_joints() -> None:
    assert all(arm_of(arm.joints) is arm for arm in ARMS)
    with pytest.raises(MessageError, match=r"no known arm; known: panda, iiwa14"):
        arm_of(["elbow"])


@pytest.mark.parametrize(
    ("over", "part"),
    [
        ("robot: {model: scara}", "'scara' is no arm; allowed: panda, iiwa14"),
        ("robot: {home: [3.0, 0, 0, -1.8, 0, 1.6, 0]}", "panda_joint1 is 3.0; allowed: -2.897 to 2.897"),
    ],
)
def test_a_cell_with_an_arm_that_cannot_be_is_refused(over: str, part: str) -> None:
    with pytest.raises(ConfigError, match=part):
        packing_cell(over)


def test_the_register_alone_knows_the_arms_by_name() -> None:
    modules = (f"pack_core.robots.{name}" for name in PACKING_ARMS)
    sources = project_root() / "ros_ws" / "src"
    importing = {
        path.name
        for module in modules
        for path in sources.glob("*/*/**/*.py")
        if f"from {module} import" in path.read_text()
    }
    assert importing == {"packing_arms.py"}
