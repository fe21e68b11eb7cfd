"""Robots as URDF: read back by MuJoCo's own reader, they move as the models that they were made from."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import mujoco
import numpy as np
import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import describe_robot as describe_blocks_robot
from pack_core.bodies import body_pose
from pack_core.errors import ConfigError
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import describe_robot as describe_packing_robot
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.model import describe_robot as describe_pallet_robot
from pack_core.robots.packing_arms import PACKING_ARMS
from pack_core.robots.seven_axis_arm import SevenAxisArm
from pack_core.robots.urdf import DescribedRobot, robot_description


def describe_arm(arm: SevenAxisArm) -> DescribedRobot:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    arm.add_to(spec)
    return DescribedRobot.of(spec, arm.name)


ROBOTS: dict[str, Callable[[], DescribedRobot]] = {
    "packing": lambda: describe_packing_robot(packing_cell()),
    "palletizing": lambda: describe_pallet_robot(palletizing_cell()),
    "blocks": lambda: describe_blocks_robot(blocks_cell()),
    **{name: partial(describe_arm, arm) for name, arm in PACKING_ARMS.items()},
}
KEEP_ALL_LINKS = '<mujoco><compiler fusestatic="false" discardvisual="false"/></mujoco>'
"""MuJoCo's own extension of URDF: it would merge links without a joint, such as the tool."""


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> DescribedRobot:
    return ROBOTS[request.param]()


def read_back(urdf: str) -> mujoco.MjModel:
    # Links without mass are no matter for kinematics, but MuJoCo wants inertia where something moves.
    moments = 'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"'
    inertia = f'<inertial><mass value="1"/><inertia {moments}/></inertial>'
    with_mass = "".join(
        line.replace("/>", f">{inertia}</link>") if line.strip().startswith("<link") and line.endswith("/>")
        else line + (inertia if line.strip().startswith("<link") else "")
        for line in urdf.splitlines(keepends=False)
    )  # fmt: skip
    return mujoco.MjModel.from_xml_string(with_mass.replace("</robot>", KEEP_ALL_LINKS + "</robot>"))


def test_every_link_is_where_the_model_has_it_at_any_posture(robot: DescribedRobot) -> None:
    model, copy = robot.model, read_back(robot.urdf)
    data, other = mujoco.MjData(model), mujoco.MjData(copy)
    joints = [copy.joint(j).name for j in range(copy.njnt)]
    assert set(robot.joints) <= set(joints)
    rng = np.random.default_rng(3)
    for _ in range(20):
        for name in joints:
            lower, upper = model.joint(name).range
            data.joint(name).qpos = other.joint(name).qpos = rng.uniform(lower, upper)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_kinematics(copy, other)
        for link in robot.links:
            X_WL, X_WU = body_pose(data, link), body_pose(other, link)
            np.testing.assert_allclose(X_WU.p, X_WL.p, atol=1e-7)
            assert abs(abs(X_WU.q @ X_WL.q) - 1.0) < 1e-12


def test_every_visible_shape_is_drawn_and_nothing_else(robot: DescribedRobot) -> None:
    drawn = robot.urdf.count("<visual>")
    ids = [robot.model.body(name).id for name in robot.links]
    geoms = [g for g in range(robot.model.ngeom) if int(robot.model.geom_bodyid[g]) in ids]
    visible = [g for g in geoms if robot.model.geom_group[g] < 3 and robot.model.geom_rgba[g, 3] > 0]
    capsules = sum(robot.model.geom_type[g] == mujoco.mjtGeom.mjGEOM_CAPSULE for g in visible)
    assert drawn == len(visible) + 2 * capsules
    assert drawn > len(robot.joints)


def test_a_body_with_two_joints_is_refused() -> None:
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="both", mass=1.0, inertia=(1.0, 1.0, 1.0))
    for axis in np.eye(3)[:2]:
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis)
    with pytest.raises(ConfigError, match="has 2 joints"):
        robot_description(spec.compile(), "both", "robot")
