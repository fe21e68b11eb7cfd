"""The perception node: markers and joints in, the scene out, and no look at the truth."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticStatus
from pack_interfaces.msg import SceneState as SceneMessage
from std_msgs.msg import String

from integration.harness import Graph
from pack_core.config import validate_config
from pack_core.packing.cell import packing_cell
from pack_core.paths import config_path
from pack_core.robots.panda import PANDA
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.packing import to_markers
from pack_core.ros.messages.scene import from_scene
from pack_core.states import SceneState, Source
from pack_perception.mocap.perception_node import PerceptionNode, PerceptionNodeConfig
from pack_sim.packing.scene_generator import generate_scene
from pack_sim.packing.simulator import Simulator, SimulatorConfig


def test_the_parameter_file_says_what_the_defaults_are() -> None:
    path = config_path("nodes", "packing", "perception.yaml")
    given = yaml.safe_load(path.read_text())["perception"]["ros__parameters"]
    assert validate_config(PerceptionNodeConfig, given, str(path)) == PerceptionNodeConfig()


class Rig:
    """A simulated cell whose sensors speak through the probe."""

    def __init__(self, graph: Graph) -> None:
        self.graph, self.cell = graph, packing_cell()
        self.scene = generate_scene(0, self.cell)
        self.simulator = Simulator(self.cell, self.scene, SimulatorConfig(), np.random.default_rng(0))
        self.node = graph.start(PerceptionNode)
        graph.probe.listen(contracts.SCENE, shared.DIAGNOSTICS)
        graph.connect(contracts.DESCRIPTION, contracts.JOINT_STATES, contracts.MARKERS)
        graph.wait_until(lambda: self.node.count_subscribers(contracts.SCENE.name))

    @property
    def names(self) -> set[str]:
        return {*self.scene.names, self.scene.new_object.name}

    def describe(self) -> None:
        text = self.scene.description().to_yaml()
        self.graph.probe.send(contracts.DESCRIPTION, String(data=text))

    def run(self, seconds: float, *, cameras: bool = True) -> None:
        """Let the cell go on, with or without cameras, and the node follow."""
        for _ in range(round(seconds / self.simulator.config.timestep)):
            self.simulator.step()
            if round(self.simulator.time * 1000) % 2 == 0:
                self.graph.probe.send(
                    contracts.JOINT_STATES, to_joint_state(self.simulator.joints(), PANDA.joints)
                )
            for frame in self.simulator.mocap.due(self.simulator.time):
                if cameras:
                    self.graph.probe.send(contracts.MARKERS, to_markers(frame))
            self.graph.spin_once(0.0)
        self.graph.wait_until(lambda: self.estimate.time > self.simulator.time - 0.017)

    @property
    def estimate(self) -> SceneState:
        message = self.graph.probe.last(contracts.SCENE)
        return from_scene(message or SceneMessage())

    def worst_error(self) -> float:
        truth = self.simulator.truth()
        return max(
            float(np.linalg.norm(item.X_WO.p - truth.objects[name].X_WO.p))
            for name, item in self.estimate.objects.items()
        )

    def health(self) -> list[DiagnosticStatus]:
        self.node.report()
        return [status for m in self.graph.probe.mail[shared.DIAGNOSTICS.name] for status in m.status]


@pytest.fixture
def rig(graph: Graph) -> Rig:
    return Rig(graph)


def test_every_object_is_found_where_it_is(rig: Rig) -> None:
    rig.describe()
    rig.run(0.5)
    assert set(rig.estimate.objects) == rig.names
    assert rig.worst_error() < 0.002
    assert all(item.source is Source.MOCAP for item in rig.estimate.objects.values())


def test_the_scene_goes_on_when_the_cameras_stop(rig: Rig) -> None:
    rig.describe()
    rig.run(0.3)
    before = len(rig.graph.probe.mail[contracts.SCENE.name])
    rig.run(0.5, cameras=False)
    assert len(rig.graph.probe.mail[contracts.SCENE.name]) - before >= 30
    assert rig.worst_error() < 0.002
    for item in rig.estimate.objects.values():
        assert item.source is Source.PHYSICS
        assert item.age == pytest.approx(0.5, abs=0.05)


def test_a_new_description_starts_over(rig: Rig) -> None:
    rig.describe()
    rig.run(0.3)
    rig.graph.probe.mail[contracts.SCENE.name].clear()
    rig.describe()
    rig.run(0.1, cameras=False)
    assert set(rig.estimate.objects) == {rig.scene.new_object.name}
    rig.run(0.3)
    assert set(rig.estimate.objects) == rig.names


def test_bad_messages_are_dropped_counted_and_reported(rig: Rig) -> None:
    rig.describe()
    rig.run(0.2)
    probe, joints = rig.graph.probe, rig.simulator.joints()
    probe.send(contracts.DESCRIPTION, String(data="friction: slippery"))
    later = joints.time + 0.1
    probe.send(
        contracts.JOINT_STATES,
        to_joint_state(replace(joints, time=later, q=np.full(7, np.nan)), PANDA.joints),
    )
    frame = rig.simulator.mocap.capture(rig.simulator.model, rig.simulator.data, joints.time)
    probe.send(contracts.MARKERS, to_markers(replace(frame, objects=("teapot", *frame.objects[1:]))))
    reports = [
        f"refused {c.name}: 1 (" for c in (contracts.DESCRIPTION, contracts.JOINT_STATES, contracts.MARKERS)
    ]
    rig.graph.wait_until(partial(_is_reported, rig, reports))
    rig.run(0.2)
    assert rig.worst_error() < 0.002


def _is_reported(rig: Rig, reports: list[str]) -> bool:
    messages = [status.message for status in rig.health() if status.name == "perception"]
    return bool(messages) and all(report in messages[-1] for report in reports)


def test_an_object_that_lost_its_grip_is_reported(rig: Rig) -> None:
    rig.describe()
    rig.run(0.2)
    rig.simulator.release()
    rig.run(0.8)
    rig.graph.wait_until(partial(_is_reported, rig, ["'passata' no longer hangs on the cup"]))
    assert rig.worst_error() < 0.005


def test_nothing_is_published_before_the_cell_is_described(rig: Rig) -> None:
    for _ in range(100):
        rig.simulator.step()
        rig.graph.probe.send(contracts.JOINT_STATES, to_joint_state(rig.simulator.joints(), PANDA.joints))
        rig.graph.spin_once(0.0)
    assert rig.graph.probe.last(contracts.SCENE) is None
    rig.describe()
    rig.run(0.1)
    assert rig.graph.probe.last(contracts.SCENE) is not None


def test_the_node_never_reads_the_truth(rig: Rig) -> None:
    topics = dict(rig.node.get_subscriber_names_and_types_by_node("perception", "/"))
    assert contracts.JOINT_STATES.name in topics
    assert contracts.TRUTH.name not in topics
