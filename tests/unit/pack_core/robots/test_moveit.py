"""Robots for MoveIt and ros2_control: files that readers which are not ours take, and that agree."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
import pytest
import yaml
from urdf_parser_py.urdf import URDF

from pack_bringup.graph.launch import launch_parameters
from pack_core.bodies import body_pose
from pack_core.cells import CELLS, cell_part
from pack_core.robots.moveit import CONTROLLER, GROUP, MOCK, MUJOCO, SCENE, TOOL, PlannedRobot
from pack_core.rotations import Array, to_matrix

STILL = 1.0
"""The MuJoCo model is left to itself for so long [s]."""


ROBOTS = (*((cell, "") for cell in CELLS), ("packing", "iiwa14"))
"""Each cell's robot, and presets with another arm."""


@cache
def robot_of(cell: str, preset: str) -> PlannedRobot:
    robot: PlannedRobot = cell_part(cell, "robot")(launch_parameters(cell, preset, ())["sim"])
    assert robot.name == preset or not preset
    return robot


@cache
def files_of(cell: str, preset: str) -> Mapping[str, str]:
    return robot_of(cell, preset).files()


@pytest.fixture(params=ROBOTS, ids="".join)
def robot(request: pytest.FixtureRequest) -> PlannedRobot:
    return robot_of(*request.param)


@pytest.fixture
def files(robot: PlannedRobot, request: pytest.FixtureRequest) -> Mapping[str, str]:
    return files_of(*request.node.callspec.params["robot"])


def transform(xyz: Array, rpy: Array) -> Array:
    """`(4, 4)` from a translation and turns about the fixed axes x, y, z (URDF)."""
    T = np.eye(4)
    for axis, angle in enumerate(rpy):
        T[:3, :3] = turn(np.eye(3)[axis], angle) @ T[:3, :3]
    T[:3, 3] = xyz
    return T


def turn(axis: Array, angle: float) -> Array:
    """Rodrigues' formula, written here anew: the robot is not to be read by what has written it."""
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def test_a_reader_of_urdf_that_is_not_mujocos_finds_every_link_where_the_model_has_it(
    robot: PlannedRobot, files: Mapping[str, str]
) -> None:
    read = URDF.from_xml_string(files[f"{robot.name}.urdf"].encode())
    assert read.get_root() == "world"
    model, data = robot.described.model, mujoco.MjData(robot.described.model)
    rng = np.random.default_rng(5)
    q = dict(
        zip(robot.limits.names, rng.uniform(robot.limits.lower, robot.limits.upper), strict=True)
    ) | dict.fromkeys(robot.fingers, 0.01)
    for name, position in q.items():
        data.joint(name).qpos = position
    mujoco.mj_kinematics(model, data)
    for link in robot.described.links:
        T = np.eye(4)
        for name in read.get_chain("world", link, links=False):
            joint = read.joint_map[name]
            T = T @ transform(np.array(joint.origin.xyz), np.array(joint.origin.rpy))
            moved = np.eye(4)
            if joint.type == "revolute":
                moved[:3, :3] = turn(np.array(joint.axis), q[name])
            elif joint.type == "prismatic":
                moved[:3, 3] = np.array(joint.axis) * q[name]
            T = T @ moved
        X = body_pose(data, link)
        np.testing.assert_allclose(T[:3, 3], X.p, atol=1e-7)
        np.testing.assert_allclose(T[:3, :3], to_matrix(X.q), atol=1e-7)


def test_that_reader_finds_masses_that_can_be_and_a_shape_for_every_moving_link(
    robot: PlannedRobot, files: Mapping[str, str]
) -> None:
    read = URDF.from_xml_string(files[f"{robot.name}.urdf"].encode())
    weighed = [link for link in read.links if link.inertial is not None]
    total = sum(link.inertial.mass for link in weighed)
    assert total == pytest.approx(float(robot.described.model.body_mass.sum()), rel=1e-6)
    for link in weighed:
        xx, yy, zz = sorted(np.diag(np.array(link.inertial.inertia.to_matrix(), float)))
        assert xx > 0.0
        assert zz <= (xx + yy) * (1 + 1e-6)  # of a rigid body, the triangle inequality
    for name in robot.limits.names:
        link = read.link_map[read.joint_map[name].child]
        assert link.visuals
        assert link.collisions
        assert link.inertial is not None


def test_names_and_limits_of_all_files_agree(robot: PlannedRobot, files: Mapping[str, str]) -> None:
    read, names = URDF.from_xml_string(files[f"{robot.name}.urdf"].encode()), list(robot.limits.names)
    limits = yaml.safe_load(files["joint_limits.yaml"])["joint_limits"]
    assert list(limits) == names
    for name, row in limits.items():
        assert row["max_velocity"] == pytest.approx(read.joint_map[name].limit.velocity, rel=1e-6)
    moveit = yaml.safe_load(files["moveit_controllers.yaml"])["moveit_simple_controller_manager"]
    control = yaml.safe_load(files["ros2_controllers.yaml"])
    assert moveit["controller_names"] == [CONTROLLER]
    assert moveit[CONTROLLER]["joints"] == control[CONTROLLER]["ros__parameters"]["joints"] == names
    assert CONTROLLER in control["controller_manager"]["ros__parameters"]
    assert list(yaml.safe_load(files["kinematics.yaml"])) == [GROUP]


def test_the_srdf_names_links_and_joints_that_exist_and_home_is_within_the_limits(
    robot: PlannedRobot, files: Mapping[str, str]
) -> None:
    read, root = URDF.from_xml_string(files[f"{robot.name}.urdf"].encode()), srdf(robot, files)
    assert root.get("name") == read.name
    chain = root.find(f"group[@name='{GROUP}']/chain")
    moving = [
        name
        for name in read.get_chain(chain.get("base_link"), chain.get("tip_link"), links=False)
        if read.joint_map[name].type != "fixed"
    ]
    assert moving == list(robot.limits.names)
    assert chain.get("tip_link") == TOOL
    home = {joint.get("name"): float(joint.get("value")) for joint in root.iterfind("group_state/joint")}
    assert list(home) == moving
    for name, value in home.items():
        assert read.joint_map[name].limit.lower < value < read.joint_map[name].limit.upper
    for pair in root.iterfind("disable_collisions"):
        assert {pair.get("link1"), pair.get("link2")} <= set(read.link_map)
    groups = {group.get("name") for group in root.iterfind("group")}
    for effector in root.iterfind("end_effector"):
        assert {effector.get("group"), effector.get("parent_group")} <= groups


def srdf(robot: PlannedRobot, files: Mapping[str, str]) -> Element:
    return ElementTree.fromstring(files[f"{robot.name}.srdf"])


def test_links_that_are_not_checked_hang_on_each_other_or_stay_apart(
    robot: PlannedRobot, files: Mapping[str, str]
) -> None:
    unchecked = {
        frozenset((pair.get("link1"), pair.get("link2"))): pair.get("reason")
        for pair in srdf(robot, files).iterfind("disable_collisions")
    }
    first, last = robot.described.links[0], robot.described.links[-1]
    assert "Adjacent" in unchecked.values()
    # an arm with six or seven axes reaches its own base with its tool
    assert frozenset((first, TOOL)) not in unchecked
    assert frozenset((first, last)) not in unchecked


@pytest.mark.parametrize(("plugin", "suffix"), [(MOCK, "mock"), (MUJOCO, "mujoco")])
def test_hardware_tags_name_the_arms_joints_with_their_limits(
    robot: PlannedRobot, files: Mapping[str, str], plugin: str, suffix: str
) -> None:
    text = files[f"{robot.name}_{suffix}.urdf"]
    assert URDF.from_xml_string(text.encode()).name == robot.name
    (system,) = ElementTree.fromstring(text).findall("ros2_control")
    assert system.find("hardware/plugin").text == plugin
    joints = system.findall("joint")
    assert [joint.get("name") for joint in joints] == list(robot.limits.names)
    for joint, lower, upper, home in zip(
        joints, robot.limits.lower, robot.limits.upper, robot.home, strict=True
    ):
        given = {each.get("name"): float(each.text) for each in joint.iter("param")}
        assert given == pytest.approx({"min": lower, "max": upper, "initial_value": home})
        states = [state.get("name") for state in joint.findall("state_interface")]
        assert states == ["position", "velocity"]


def test_the_model_of_mujocos_system_stands_at_home(robot: PlannedRobot, files: Mapping[str, str]) -> None:
    model = mujoco.MjModel.from_xml_string(files[SCENE])
    assert [model.actuator(a).name for a in range(model.nu)] == list(robot.limits.names)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    while data.time < STILL:
        mujoco.mj_step(model, data)
    q = np.array([data.joint(name).qpos[0] for name in robot.limits.names])
    assert np.abs(q - robot.home).max() < 0.03
    assert np.abs(data.qvel).max() < 0.01
