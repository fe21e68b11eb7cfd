"""Goals that the controller's node does not take, and why it says so."""

from __future__ import annotations

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from pack_interfaces.action import PackObject
from std_msgs.msg import String

from integration.harness import Graph
from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.robots.panda import PANDA
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.scene import to_scene
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_mpc.mpc_node import MpcNode


@pytest.fixture
def scene() -> Scene:
    return load_scene(config_path("scenarios", "packing", "example.yaml"))


@pytest.fixture
def mpc(graph: Graph) -> MpcNode:
    graph.probe.listen(shared.DIAGNOSTICS)
    node = graph.start(MpcNode)
    graph.connect(contracts.DESCRIPTION, contracts.JOINT_STATES, contracts.SCENE)
    return node


def tell(graph: Graph, scene: Scene, *, missing: str = "") -> None:
    """Speak for sim and perception, once."""
    at_rest = JointSample(1.0, np.array(packing_cell().robot.home), np.zeros(7), np.zeros(7))
    poses = scene.poses() | {scene.new_object.name: Pose([0.5, 0.0, 0.36])}
    objects = {name: ObjectState(X_WO) for name, X_WO in poses.items() if name != missing}
    graph.probe.send(contracts.DESCRIPTION, String(data=scene.description().to_yaml()))
    graph.probe.send(contracts.JOINT_STATES, to_joint_state(at_rest, PANDA.joints))
    graph.probe.send(contracts.SCENE, to_scene(SceneState(1.0, objects)))


def refusal(graph: Graph, **fields: object) -> str:
    """What the sender of a goal that is not taken is told, and /diagnostics says."""
    reason = graph.refusal(contracts.PACK_OBJECT, PackObject.Goal(**fields))
    mail = graph.probe.mail[shared.DIAGNOSTICS.name]
    graph.wait_until(lambda: mail and reason in mail[-1].status[0].message)
    status = mail[-1].status[0]
    assert (status.name, status.level) == ("mpc", DiagnosticStatus.WARN)
    return reason


def test_a_goal_before_anything_was_heard_is_refused(graph: Graph, mpc: MpcNode) -> None:
    assert "no /cell_description yet: is sim up?" in refusal(graph)


def test_a_goal_is_refused_while_the_object_to_pack_has_not_been_found(
    graph: Graph, mpc: MpcNode, scene: Scene
) -> None:
    held = scene.new_object.name
    tell(graph, scene, missing=held)
    graph.wait_until(lambda: held in mpc.waits_for)
    assert f"the cameras have not seen {held} yet" in refusal(graph)


def test_a_goal_may_begin_while_another_object_has_not_been_found(
    graph: Graph, mpc: MpcNode, scene: Scene
) -> None:
    tell(graph, scene, missing="tea_box")
    graph.wait_until(lambda: not mpc.waits_for)


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"method": "magic"}, "method 'magic'; allowed: pack_it_in, uninformed_pose, uninformed_physics"),
        ({"timeout": -1.0}, "timeout -1.0; allowed: seconds from 0 on"),
        ({"timeout": math.nan}, "timeout nan; allowed: seconds from 0 on"),
    ],
)
def test_a_goal_that_makes_no_sense_is_refused_with_what_is_allowed(
    graph: Graph, mpc: MpcNode, scene: Scene, fields: dict[str, object], reason: str
) -> None:
    tell(graph, scene)
    graph.wait_until(lambda: not mpc.waits_for)
    assert reason in refusal(graph, **fields)
