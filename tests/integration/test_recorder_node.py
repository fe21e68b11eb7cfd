from collections.abc import Callable
from pathlib import Path

import pytest
import yaml
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from integration.harness import Graph
from pack_bringup.recording.recorder_node import RecorderNode
from pack_core.packing.scene_file import load_scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.table import recorded
from pack_core.ros.conversions import to_stamp
from pack_core.ros.scene_messages import to_scene
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_evaluation.raw_bag import read_raw_bag


@pytest.fixture
def recorder(graph: Graph, tmp_path: Path) -> RecorderNode:
    node = graph.start(RecorderNode, path=str(tmp_path / "run"), seed=5, command="pack demo")
    graph.connect(shared.CLOCK, contracts.JOINT_STATES, contracts.DESCRIPTION, contracts.TRUTH)
    return node


def received(node: RecorderNode, topic: contracts.Contract, count: int) -> Callable[[], bool]:
    return lambda: node.recorder.written[topic.name] >= count


def test_stamps_are_the_simulated_time_at_which_a_message_was_sent(
    graph: Graph, recorder: RecorderNode, tmp_path: Path
) -> None:
    graph.probe.send(contracts.JOINT_STATES, JointState())
    for k in range(1, 6):
        graph.probe.send(shared.CLOCK, Clock(clock=to_stamp(0.1 * k)))
        graph.probe.send(contracts.JOINT_STATES, JointState())
    graph.wait_until(received(recorder, contracts.JOINT_STATES, 6))
    graph.stop(recorder)
    bag = read_raw_bag(tmp_path / "run", [contracts.JOINT_STATES.name])
    assert [item.time_ns for item in bag.messages] == [k * 100_000_000 for k in range(6)]


def test_every_recorded_contract_is_in_the_bag_with_its_type_and_qos(
    graph: Graph, recorder: RecorderNode, tmp_path: Path
) -> None:
    graph.stop(recorder)
    bag = read_raw_bag(tmp_path / "run")
    assert set(bag.topics) == {contract.name for contract in recorded("packing")}
    assert bag.topics["/scene"].type == "pack_interfaces/msg/SceneState"
    (offered,) = bag.topics["/cell_description"].offered_qos
    assert (offered.durability.name, offered.depth) == ("TRANSIENT_LOCAL", 1)


def test_the_run_is_described_beside_the_bag(graph: Graph, recorder: RecorderNode, tmp_path: Path) -> None:
    record = yaml.safe_load((tmp_path / "run" / "run.yaml").read_text())
    assert (record["seed"], record["command"], record["cell"]) == (5, "pack demo", "packing")
    assert record["versions"]["mujoco"]
    assert {"cells/packing.yaml", "nodes/packing/recorder.yaml"} <= set(record["configuration"])


def test_description_and_first_truth_make_a_scene_file_to_run_again(
    graph: Graph, recorder: RecorderNode, tmp_path: Path
) -> None:
    scene = load_scene(Path(__file__).parents[2] / "config" / "scenarios" / "packing" / "example.yaml")
    poses = {**scene.poses(), scene.new_object.name: Pose([0.5, 0.0, 0.4])}
    truth = SceneState(0.1, {name: ObjectState(X_WO) for name, X_WO in poses.items()})
    graph.probe.send(contracts.DESCRIPTION, String(data=scene.description().to_yaml()))
    graph.probe.send(contracts.TRUTH, to_scene(truth))
    graph.wait_until((tmp_path / "run" / "scene.yaml").is_file)
    again = load_scene(tmp_path / "run" / "scene.yaml")
    assert again.description() == scene.description()
    for name, X_WO in scene.poses().items():
        assert again.poses()[name].p == pytest.approx(X_WO.p)


def test_a_bad_description_is_counted_recorded_and_survived(
    graph: Graph, recorder: RecorderNode, tmp_path: Path
) -> None:
    graph.probe.send(contracts.DESCRIPTION, String(data="container: 5"))
    graph.wait_until(received(recorder, contracts.DESCRIPTION, 1))
    assert recorder.health.counts["refused /cell_description"] == 1


def test_a_failing_disk_is_reported_as_a_fault(graph: Graph, recorder: RecorderNode) -> None:
    graph.probe.listen(shared.DIAGNOSTICS)
    recorder.recorder.fault = "recording stopped: no space left on device"
    graph.wait_until(
        lambda: any(
            "no space left" in message.status[0].message and message.status[0].level == b"\x02"
            for message in graph.probe.mail[shared.DIAGNOSTICS.name]
        )
    )
