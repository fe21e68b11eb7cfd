from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from action_msgs.msg import GoalStatus, GoalStatusArray
from pack_interfaces.action import PackObject
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from integration.harness import Graph
from pack_bringup.recording.recorder_node import RecorderNode
from pack_bringup.recording.ros.recorded_topics import GoalsInProgress, status_contracts
from pack_core.errors import BagError
from pack_core.packing.scene_file import load_scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.table import recorded
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.scene import to_scene
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_evaluation.bag import read_bag
from pack_evaluation.raw_bag import read_raw_bag


@pytest.fixture
def recorder(graph: Graph, tmp_path: Path) -> RecorderNode:
    path = str(tmp_path / "run")
    node = graph.start(RecorderNode, path=path, seed=5, command="pack demo", record="always")
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


def test_between_two_ticks_of_the_clock_joint_states_of_the_same_clock_tell_the_time(
    graph: Graph, recorder: RecorderNode, tmp_path: Path
) -> None:
    def send_joints(time: float) -> None:
        message = JointState()
        message.header.stamp = to_stamp(time)
        graph.probe.send(contracts.JOINT_STATES, message)

    graph.probe.send(shared.CLOCK, Clock(clock=to_stamp(5.0)))
    # The third is older than the second, and the last is stamped by another clock.
    for time in (5.002, 5.004, 5.002, 900.0):
        send_joints(time)
    graph.wait_until(received(recorder, contracts.JOINT_STATES, 4))
    graph.stop(recorder)
    bag = read_raw_bag(tmp_path / "run", [contracts.JOINT_STATES.name])
    stamped = [item.time_ns for item in bag.messages]
    assert stamped == [5_002_000_000, 5_004_000_000, 5_004_000_000, 5_004_000_000]


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
    graph.probe.send(contracts.SIM_DESCRIPTION, String(data=scene.description().to_yaml()))
    graph.probe.send(contracts.TRUTH, to_scene(truth))
    graph.wait_until((tmp_path / "run" / "scene.yaml").is_file)
    again = load_scene(tmp_path / "run" / "scene.yaml")
    assert again.description() == scene.description()
    for name, X_WO in scene.poses().items():
        assert again.poses()[name].p == pytest.approx(X_WO.p)


def test_a_bad_description_is_counted_recorded_and_survived(
    graph: Graph, recorder: RecorderNode, tmp_path: Path
) -> None:
    graph.probe.send(contracts.SIM_DESCRIPTION, String(data="container: 5"))
    graph.wait_until(received(recorder, contracts.SIM_DESCRIPTION, 1))
    assert recorder.health.counts["refused /sim/description"] == 1


def test_a_failing_disk_is_reported_as_a_fault(graph: Graph, recorder: RecorderNode) -> None:
    graph.probe.listen(shared.DIAGNOSTICS)
    recorder.recorder.fault = "recording stopped: no space left on device"
    graph.wait_until(
        lambda: any(
            "no space left" in message.status[0].message and message.status[0].level == b"\x02"
            for message in graph.probe.mail[shared.DIAGNOSTICS.name]
        )
    )


def test_a_folder_that_cannot_be_written_is_a_fault_with_which_the_cell_goes_on(
    graph: Graph, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    graph.probe.listen(shared.DIAGNOSTICS)
    node = graph.start(RecorderNode, path=str(tmp_path / "file" / "run"))
    graph.wait_until(
        lambda: any(
            "cannot record to" in message.status[0].message and message.status[0].level == b"\x02"
            for message in graph.probe.mail[shared.DIAGNOSTICS.name]
        )
    )
    assert "goals go on unrecorded" in node.health.faults["bag"]
    graph.wait_until(lambda: node.is_up)


def test_a_recorder_that_is_required_ends_where_it_cannot_write(graph: Graph, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(BagError, match="Not a directory"):
        graph.start(RecorderNode, path=str(tmp_path / "file" / "run"), required=True)


class Packer(GoalNode):
    """Pursues the packing cell's goals until the test ends them."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("mpc", **kwargs)
        self.results = self.advertise(contracts.RESULT)
        self.take_goals(contracts.PACK_OBJECT, [], 1.0)

    async def pursue(self, request: PackObject.Goal) -> PackObject.Result:
        await self.until_goal_ends()
        self.results.publish(String(data="{}"))
        return PackObject.Result(success=True)

    def on_lost_peers(self, peers: list[str]) -> None:
        """Nobody is watched."""

    def on_arm_stop(self, reason: str) -> None:
        """There is no arm."""

    def give_up(self) -> None:
        """There is no arm."""


@pytest.fixture
def by_goals(graph: Graph, tmp_path: Path) -> RecorderNode:
    node = graph.start(RecorderNode, path=str(tmp_path / "run"))
    graph.connect(shared.CLOCK, contracts.JOINT_STATES, contracts.DESCRIPTION)
    return node


def positions(folder: Path) -> list[float]:
    """What the joint states in a bag say."""
    return [item.message.position[0] for item in read_bag(folder, [contracts.JOINT_STATES.name]).messages]


def test_by_default_goals_are_recorded_whole_with_what_was_latched_before(
    graph: Graph, by_goals: RecorderNode, tmp_path: Path
) -> None:
    packer = graph.start(Packer)
    graph.probe.send(contracts.DESCRIPTION, String(data="the cell"))
    graph.probe.send(shared.CLOCK, Clock(clock=to_stamp(50.0)))
    graph.probe.send(contracts.JOINT_STATES, JointState(position=[1.0]))
    handle = graph.send_goal(contracts.PACK_OBJECT, PackObject.Goal())
    assert handle.accepted
    graph.probe.send(contracts.JOINT_STATES, JointState(position=[2.0]))
    packer.end_goal()
    graph.result_of(handle)
    graph.probe.send(contracts.JOINT_STATES, JointState(position=[3.0]))
    graph.wait_until(received(by_goals, contracts.JOINT_STATES, 3))
    graph.wait_until(received(by_goals, contracts.RESULT, 1))
    graph.stop(by_goals)
    assert positions(tmp_path / "run") == [1.0, 2.0, 3.0]
    assert read_bag(tmp_path / "run", [contracts.DESCRIPTION.name]).messages[0].message.data == "the cell"


def test_without_a_goal_the_bag_stays_empty(graph: Graph, by_goals: RecorderNode, tmp_path: Path) -> None:
    graph.probe.send(contracts.JOINT_STATES, JointState(position=[1.0]))
    graph.wait_until(lambda: by_goals.received)
    graph.stop(by_goals)
    assert positions(tmp_path / "run") == []


def test_a_recorder_that_joins_during_a_goal_records_it(graph: Graph, tmp_path: Path) -> None:
    graph.start(Packer)
    assert graph.send_goal(contracts.PACK_OBJECT, PackObject.Goal()).accepted
    node = graph.start(RecorderNode, path=str(tmp_path / "run"))
    graph.connect(contracts.JOINT_STATES)
    graph.wait_until(lambda: node.is_recording)
    graph.probe.send(contracts.JOINT_STATES, JointState(position=[1.0]))
    graph.wait_until(received(node, contracts.JOINT_STATES, 1))


def test_the_end_of_the_node_that_pursues_a_goal_ends_its_recording(
    graph: Graph, by_goals: RecorderNode
) -> None:
    packer = graph.start(Packer)
    assert graph.send_goal(contracts.PACK_OBJECT, PackObject.Goal()).accepted
    graph.wait_until(lambda: by_goals.is_recording and by_goals.hears("mpc"))
    graph.stop(packer)
    graph.wait_until(lambda: not by_goals.is_recording)


def test_a_status_from_before_its_senders_end_that_comes_after_it_begins_no_recording() -> None:
    (status,) = status_contracts("blocks")
    (server,) = status.sources
    goal = GoalStatusArray(status_list=[GoalStatus(status=GoalStatus.STATUS_EXECUTING)])
    goals = GoalsInProgress((status,))
    goals.on_lost_node(server, 2_000)
    goals.on_status(status.name, 1_000, serialize_message(goal))
    assert not goals
    goals.on_status(status.name, 3_000, serialize_message(goal))  # of the node that was started anew
    assert goals
    goals.on_lost_node(server, 4_000)
    assert not goals


def test_never_means_that_no_file_is_written(graph: Graph, tmp_path: Path) -> None:
    node = graph.start(RecorderNode, path=str(tmp_path / "run"), record="never")
    graph.stop(node)
    assert not (tmp_path / "run").exists()


def test_a_start_says_where_what_and_how_much_is_recorded(
    graph: Graph, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    graph.start(RecorderNode, path=str(tmp_path / "run"), split_mb=100.0, limit_gb=2.5)
    said = capfd.readouterr().err
    for part in ("goals", str(tmp_path / "run"), "100 MB", "2.5 GB", "recording stops"):
        assert part in said
