"""Robots as URDF: read back by MuJoCo's own reader, they move as the models that they were made from."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from xml.etree import ElementTree

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
from pack_core.rotations import Array


def describe_arm(arm: SevenAxisArm) -> DescribedRobot:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    arm.add_to(spec)
    return DescribedRobot.of(spec, arm.name, arm.limits)


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
    return mujoco.MjModel.from_xml_string(urdf.replace("</robot>", KEEP_ALL_LINKS + "</robot>"))


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


def test_it_weighs_and_resists_as_the_model_does_at_any_posture(robot: DescribedRobot) -> None:
    """Mass matrix, less the motors' inertia, which URDF cannot express, and torques against the weight."""
    model, copy = robot.model, read_back(robot.urdf)
    model.dof_armature[:] = 0.0
    assert [copy.joint(j).name for j in range(copy.njnt)] == [model.joint(j).name for j in range(model.njnt)]
    rng = np.random.default_rng(4)
    for _ in range(5):
        q = rng.uniform(*model.jnt_range.T)
        masses, weights = zip(*(dynamics(each, q) for each in (model, copy)), strict=True)
        np.testing.assert_allclose(*masses, rtol=1e-6, atol=1e-8 * masses[0].max())
        np.testing.assert_allclose(*weights, rtol=1e-6, atol=1e-8 * np.abs(weights[0]).max())


def dynamics(model: mujoco.MjModel, q: Array) -> tuple[Array, Array]:
    """Mass matrix `(n, n)` and torques against the weight `(n,)` at a posture."""
    data, M = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, M)
    return M, data.qfrc_bias.copy()


def test_every_link_that_is_drawn_can_touch_and_every_moving_one_has_limits(robot: DescribedRobot) -> None:
    links = ElementTree.fromstring(robot.urdf).findall("link")
    shaped = {link.get("name") for link in links if link.find("visual") is not None}
    assert shaped == {link.get("name") for link in links if link.find("collision") is not None}
    limits = {
        joint.get("name"): joint.find("limit") for joint in ElementTree.fromstring(robot.urdf).iter("joint")
    }
    for name in robot.joints:
        if "finger" not in name:
            assert float(limits[name].get("velocity")) > 0.0
            assert float(limits[name].get("effort")) > 0.0


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
        robot_description(spec.compile(), "both", "robot", packing_cell().robot.arm.limits)
