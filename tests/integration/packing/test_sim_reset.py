"""New scenes for a running simulator, and broken ones."""

from __future__ import annotations

import numpy as np
import pytest
from pack_interfaces.srv import PresentObject, ResetScene

from integration.harness import Graph
from integration.packing.sim_rig import EXAMPLE, newest_joints, ramp, stamps_of, start_sim
from pack_core.packing.cell import packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_core.robots.panda import PANDA
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.joints import to_trajectory
from pack_core.ros.messages.scene import from_scene
from pack_sim.packing import sim_node
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.sim_node import PackingSimNode

SENSORS = (contracts.TRUTH, contracts.JOINT_STATES)


def reset(graph: Graph, node: PackingSimNode, **fields: object) -> ResetScene.Response:
    response = graph.call(contracts.RESET, ResetScene.Request(**fields), timeout=30.0)
    answered = node.simulator.time
    graph.wait_until(lambda: min(stamps_of(graph, contract)[-1] for contract in SENSORS) > answered)
    return response


def poses_of(graph: Graph, scene: Scene) -> np.ndarray:
    truth = from_scene(graph.probe.last(contracts.TRUTH)).poses()
    return np.array([truth[name].p for name in scene.names])


def expected_poses(scene: Scene) -> np.ndarray:
    return np.array([X_WO.p for X_WO in scene.poses().values()])


def test_reset_with_a_seed_brings_that_scene_and_the_arm_home(graph: Graph) -> None:
    node = start_sim(graph)
    before = newest_joints(graph)
    graph.probe.send(contracts.SETPOINTS, to_trajectory(ramp(before, 1.0), PANDA.joints))
    graph.wait_until(lambda: newest_joints(graph).q[0] > before.q[0] + 0.01)
    response = reset(graph, node, seed=3)
    assert response.success, response.message
    scene = generate_scene(3, packing_cell())
    np.testing.assert_allclose(poses_of(graph, scene), expected_poses(scene), atol=0.002)
    np.testing.assert_allclose(newest_joints(graph).q, packing_cell().robot.home, atol=0.005)
    assert np.all(np.diff(stamps_of(graph, contracts.JOINT_STATES)) > 0.0)
    assert node.simulator.follower.is_holding


def test_reset_with_a_scene_text_brings_that_scene_and_its_description(graph: Graph) -> None:
    node, scene = start_sim(graph), load_scene(EXAMPLE)
    scene = scene.model_copy(update={"objects": scene.objects[:2]})
    response = reset(graph, node, scene=scene.to_yaml())
    assert response.success, response.message
    np.testing.assert_allclose(poses_of(graph, scene), expected_poses(scene), atol=0.002)
    assert Scene.from_yaml(graph.probe.last(contracts.DESCRIPTION).data) == scene.description()


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("friction: 0.4", "friction: slippery", ("request", "friction", "slippery", "number")),
        ("mass: 0.4\n", "mass: 99\n", ("objects.0", "mass", "99", "allowed")),
        ("soup_can", "tea_box", ("objects share a name", "tea_box", "allowed")),
        ("- 0.422", "- 0.9", ("objects.soup_can.pose", "0.9", "allowed", "0.365 to 0.635")),
    ],
)
def test_a_broken_scene_text_is_refused_by_key_value_and_what_is_allowed(
    graph: Graph, old: str, new: str, parts: tuple[str, ...]
) -> None:
    node, scene = start_sim(graph), load_scene(EXAMPLE)
    text = scene.to_yaml()
    assert old in text
    response = reset(graph, node, scene=text.replace(old, new, 1))
    assert not response.success
    for part in parts:
        assert part in response.message
    np.testing.assert_allclose(poses_of(graph, scene), expected_poses(scene), atol=0.002)


@pytest.mark.parametrize(
    ("contract", "part", "request_"),
    [
        (contracts.RESET, "generate_scene", ResetScene.Request(seed=3)),
        (contracts.PRESENT, "parse_object", PresentObject.Request()),
    ],
    ids=["reset", "present"],
)
def test_an_error_that_nobody_foresaw_is_answered_as_a_failure_and_counted(
    graph: Graph, monkeypatch: pytest.MonkeyPatch, contract: Contract, part: str, request_: object
) -> None:
    graph.failures_allowed = True
    node = start_sim(graph)

    def fail(*_: object) -> None:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr(sim_node, part, fail)
    response = graph.call(contract, request_, timeout=30.0)
    assert not response.success
    assert "failed: ZeroDivisionError('a bug')" in response.message
    assert node.health.counts[f"failed {contract.name}"] == 1
