"""A robot for MoveIt and ros2_control: SRDF, limits, controllers, hardware tags, a model of MuJoCo.

Everything is made from what the cells themselves use, so that nothing is stated twice. The formats are those
of MoveIt's Setup Assistant and of ros2_control in ROS 2 Jazzy.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np
import yaml

from pack_core.robots.joint_properties import JointLimits
from pack_core.robots.urdf import DescribedRobot
from pack_core.rotations import Array

GROUP, TOOL_GROUP = "arm", "gripper"
"""Names of the planning groups: the arm from its base to the link `tool`, and fingers if there are some."""
TOOL = "tool"
CONTROLLER = "joint_trajectory_controller"
POSTURES = 400
"""Random postures at which distances between links are looked at."""
APART = 0.05
"""Links that never come nearer than this need not be checked against each other [m]."""
FAR = 1.0
"""Distance beyond which none is computed [m]."""
STIFF = 0.02
"""Of the MuJoCo model: the angle by which a joint gives under its largest torque [rad]."""
MOCK, MUJOCO = "mock_components/GenericSystem", "mujoco_ros2_control/MujocoSystemInterface"
"""Plugins of ros2_control for which hardware tags are made."""
SCENE = "scene.xml"
Pair = tuple[str, str]
"""Names of two links."""


@dataclass(frozen=True)
class PlannedRobot:
    """What planners and controllers that are not ours must know of a robot.

    Attributes:
        name: of the robot.
        described: its links, joints and shapes.
        limits: of the arm's joints.
        home: their positions at rest `(n,)` [rad].
    """

    name: str
    described: DescribedRobot
    limits: JointLimits
    home: tuple[float, ...]

    @property
    def fingers(self) -> tuple[str, ...]:
        """Joints that are not the arm's."""
        return tuple(joint for joint in self.described.joints if joint not in self.limits.names)

    def files(self) -> Mapping[str, str]:
        """Text of each file, by its name."""
        unchecked = unchecked_pairs(self)
        return {
            f"{self.name}.urdf": self.described.urdf,
            f"{self.name}.srdf": srdf(self, unchecked),
            "kinematics.yaml": _yaml(kinematics()),
            "joint_limits.yaml": _yaml(joint_limits(self.limits)),
            "moveit_controllers.yaml": _yaml(moveit_controllers(self.limits)),
            "ros2_controllers.yaml": _yaml(ros2_controllers(self.limits)),
            f"{self.name}_mock.urdf": with_hardware(self, MOCK, {"calculate_dynamics": "true"}),
            f"{self.name}_mujoco.urdf": with_hardware(self, MUJOCO, {"mujoco_model": SCENE}),
            SCENE: mujoco_scene(self, unchecked),
        }


def srdf(robot: PlannedRobot, unchecked: Mapping[Pair, str]) -> str:
    """Groups, the posture `home`, the tool as end effector, and pairs of links that need no check."""
    root = Element("robot", name=robot.name)
    arm = SubElement(root, "group", name=GROUP)
    SubElement(arm, "chain", base_link=robot.described.links[0], tip_link=TOOL)
    if robot.fingers:
        hand = SubElement(root, "group", name=TOOL_GROUP)
        for joint in robot.fingers:
            SubElement(hand, "joint", name=joint)
        SubElement(root, "end_effector", name="hand", parent_link=TOOL, group=TOOL_GROUP, parent_group=GROUP)
    home = SubElement(root, "group_state", name="home", group=GROUP)
    for joint, position in zip(robot.limits.names, robot.home, strict=True):
        SubElement(home, "joint", name=joint, value=f"{position:.9g}")
    for (one, other), reason in sorted(unchecked.items()):
        SubElement(root, "disable_collisions", link1=one, link2=other, reason=reason)
    return _xml(root)


def unchecked_pairs(robot: PlannedRobot) -> dict[Pair, str]:
    """Pairs of links that need no check, with the reason as MoveIt's Setup Assistant calls it.

    One link hangs on the other, they touch at home, or they stay more than `APART` from each other at all
    of `POSTURES` random postures.
    """
    model, data = robot.described.model, mujoco.MjData(robot.described.model)
    geoms = _geoms_of(model, robot.described.links)
    shaped = [link for link in robot.described.links if geoms[link]]
    least = dict.fromkeys(combinations(shaped, 2), np.inf)
    _put(model, data, robot, np.array(robot.home))
    at_home = {pair: _distance(model, data, geoms, pair) for pair in least}
    rng = np.random.default_rng(0)
    for _ in range(POSTURES):
        _put(model, data, robot, rng.uniform(robot.limits.lower, robot.limits.upper))
        for pair, before in least.items():
            if before > 0.0:
                least[pair] = min(before, _distance(model, data, geoms, pair))
    found = {}
    for pair, distance in least.items():
        if _is_adjacent(model, pair, shaped):
            found[pair] = "Adjacent"
        elif at_home[pair] <= 0.0:
            found[pair] = "Default"
        elif distance > APART:
            found[pair] = "Never"
    return found


def kinematics() -> dict[str, Any]:
    """The solver that MoveIt has without a plugin of the arm's own."""
    return {
        GROUP: {
            "kinematics_solver": "kdl_kinematics_plugin/KDLKinematicsPlugin",
            "kinematics_solver_search_resolution": 0.005,
            "kinematics_solver_timeout": 0.05,
        }
    }


def joint_limits(limits: JointLimits) -> dict[str, Any]:
    """Velocities [rad/s] and accelerations [rad/s^2] that the cells themselves keep."""
    return {
        "joint_limits": {
            name: {
                "has_velocity_limits": True, "max_velocity": float(velocity),
                "has_acceleration_limits": True, "max_acceleration": float(acceleration),
            }
            for name, velocity, acceleration in zip(
                limits.names, limits.velocity, limits.acceleration, strict=True
            )
        }
    }  # fmt: skip


def moveit_controllers(limits: JointLimits) -> dict[str, Any]:
    """The controller to which MoveIt sends what it has planned."""
    manager = "moveit_simple_controller_manager"
    return {
        "moveit_controller_manager": f"{manager}/MoveItSimpleControllerManager",
        manager: {
            "controller_names": [CONTROLLER],
            CONTROLLER: {
                "type": "FollowJointTrajectory", "action_ns": "follow_joint_trajectory", "default": True,
                "joints": list(limits.names),
            },
        },
    }  # fmt: skip


def ros2_controllers(limits: JointLimits) -> dict[str, Any]:
    """Controllers for the controller manager of ros2_control."""
    states = "joint_state_broadcaster"
    return {
        "controller_manager": {
            "ros__parameters": {
                "update_rate": 250,
                CONTROLLER: {"type": f"{CONTROLLER}/JointTrajectoryController"},
                states: {"type": f"{states}/JointStateBroadcaster"},
            }
        },
        CONTROLLER: {
            "ros__parameters": {
                "joints": list(limits.names), "command_interfaces": ["position"],
                "state_interfaces": ["position", "velocity"],
                "allow_nonzero_velocity_at_trajectory_end": False,
            }
        },
    }  # fmt: skip


def with_hardware(robot: PlannedRobot, plugin: str, parameters: Mapping[str, str]) -> str:
    """The URDF with the tags of ros2_control for a plugin: positions are commanded, and begin at home."""
    root = ElementTree.fromstring(robot.described.urdf)
    system = SubElement(root, "ros2_control", name=f"{robot.name}_system", type="system")
    hardware = SubElement(system, "hardware")
    SubElement(hardware, "plugin").text = plugin
    for name, value in parameters.items():
        SubElement(hardware, "param", name=name).text = value
    limits = robot.limits
    rows = zip(limits.names, limits.lower, limits.upper, robot.home, strict=True)
    for name, lower, upper, home in rows:
        joint = SubElement(system, "joint", name=name)
        command = SubElement(joint, "command_interface", name="position")
        for what, value in (("min", lower), ("max", upper)):
            SubElement(command, "param", name=what).text = f"{value:.9g}"
        position = SubElement(joint, "state_interface", name="position")
        SubElement(position, "param", name="initial_value").text = f"{home:.9g}"
        SubElement(joint, "state_interface", name="velocity")
    return _xml(root)


def mujoco_scene(robot: PlannedRobot, unchecked: Collection[Pair]) -> str:
    """The URDF as a model of MuJoCo with a position servo for each joint of the arm, and home as a keyframe.

    A servo gives by `STIFF` under the joint's largest torque, and is damped critically at home. What the URDF
    cannot say is added: the motors' inertia, and which links are never in each other's way.
    """
    spec = mujoco.MjSpec.from_string(robot.described.urdf)
    spec.compiler.fusestatic = False
    spec.modelname = robot.name
    plain = robot.described.model
    for joint in robot.described.joints:
        spec.joint(joint).armature = plain.dof_armature[plain.joint(joint).dofadr[0]]
    for one, other in sorted(unchecked):
        spec.add_exclude(bodyname1=one, bodyname2=other)
    rows = zip(robot.limits.names, robot.limits.effort, robot.limits.lower, robot.limits.upper, strict=True)
    for name, effort, lower, upper in rows:
        servo = spec.add_actuator(
            name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, ctrllimited=True,
            ctrlrange=(lower, upper), forcelimited=True, forcerange=(-effort, effort),
        )  # fmt: skip
        servo.set_to_position(kp=effort / STIFF, dampratio=1.0)
    model = spec.compile()
    q = model.qpos0.copy()
    for name, position in zip(robot.limits.names, robot.home, strict=True):
        q[model.joint(name).qposadr[0]] = position
    spec.add_key(name="home", qpos=q, ctrl=list(robot.home))
    spec.compile()
    text: str = spec.to_xml()
    return text


def _geoms_of(model: mujoco.MjModel, links: tuple[str, ...]) -> dict[str, list[int]]:
    """Shapes of each link, as its URDF has them for collisions."""
    found = {}
    for link in links:
        body = model.body(link)
        geoms = range(int(body.geomadr[0]), int(body.geomadr[0]) + int(body.geomnum[0]))
        touching = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]
        found[link] = touching or list(geoms)
    return found


def _put(model: mujoco.MjModel, data: mujoco.MjData, robot: PlannedRobot, q: Array) -> None:
    for name, position in zip(robot.limits.names, q, strict=True):
        data.joint(name).qpos = position
    mujoco.mj_kinematics(model, data)


def _distance(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Mapping[str, list[int]], pair: Pair
) -> float:
    """Least distance of two links [m], at most `FAR`; not above 0 where they touch."""
    one, other = pair
    pairs = ((a, b) for a in geoms[one] for b in geoms[other])
    return float(min(mujoco.mj_geomDistance(model, data, a, b, FAR, None) for a, b in pairs))


def _is_adjacent(model: mujoco.MjModel, pair: Pair, shaped: list[str]) -> bool:
    """Whether one hangs on the other, with nothing in between but links without a shape."""
    for one, other in (pair, pair[::-1]):
        body = model.body(one).parentid[0]
        while body and model.body(body).name not in shaped:
            body = model.body(body).parentid[0]
        if body and model.body(body).name == other:
            return True
    return False


def _xml(root: Element) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _yaml(values: Mapping[str, Any]) -> str:
    text: str = yaml.safe_dump(dict(values), sort_keys=False)
    return text
