"""The node that serves the page, without a browser: what it tells, and what it asks of the cell."""

import socket
from types import SimpleNamespace

import pytest
from pack_interfaces.msg import ArmState, NodeStatus
from pack_interfaces.srv import ResetScene, StopArm
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from integration.harness import Graph
from pack_core.errors import ConfigError, PackError
from pack_core.packing.cell import packing_cell
from pack_core.packing.packing_list import parse_list
from pack_core.packing.scene_file import load_scene
from pack_core.paths import config_path
from pack_core.robots.packing_arms import PACKING_ARMS
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.simulation_types import SetSimulationState, SimulationState
from pack_mpc.mpc_node import MpcNode
from pack_sim.packing.sim_node import wanted_scene
from pack_viewer.live_node import LiveNode
from pack_viewer.packing.ros.packing_run_form import FILL

ARM = PACKING_ARMS["panda"]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def node(graph: Graph) -> LiveNode:
    """The page of a packing cell whose other nodes are the probe."""
    started = graph.start(LiveNode, cell="packing", port=free_port())
    statuses = (shared.NODE_STATUS, shared.SIMULATION_STATE, shared.ARM_STATE)
    graph.connect(*statuses)
    graph.probe.send(shared.NODE_STATUS, NodeStatus(name="mpc", state=NodeStatus.READY))
    graph.probe.send(shared.SIMULATION_STATE, SimulationState(state=SimulationState.STATE_PLAYING))
    graph.probe.send(shared.ARM_STATE, ArmState())
    graph.wait_until(lambda: started.operator.condition.can_start)
    return started


def serve(graph: Graph, contract: object, answer: object) -> list[object]:
    """Answer a service as the simulator would; the requests so far."""
    asked: list[object] = []

    def note(request: object, _: object) -> object:
        asked.append(request)
        return answer

    graph.probe.create_service(contract.type, contract.name, note)
    return asked


def test_the_scene_is_drawn_as_soon_as_arm_and_objects_are_known(graph: Graph, node: LiveNode) -> None:
    scene = load_scene(config_path("scenarios", "packing", "example.yaml"))
    graph.connect(contracts.DESCRIPTION, contracts.JOINT_STATES)
    graph.probe.send(contracts.DESCRIPTION, String(data=scene.description().to_yaml()))
    joints = JointState(name=list(ARM.joints), position=[0.0] * 7, velocity=[0.0] * 7, effort=[0.0] * 7)
    graph.probe.send(contracts.JOINT_STATES, joints)
    graph.wait_until(lambda: node.page.cell.scene.drawn is not None)
    assert node.page.cell.scene.drawn.body(scene.new_object.name) is not None


def test_stop_asks_the_driver_and_says_who_did(graph: Graph, node: LiveNode) -> None:
    asked = serve(graph, shared.STOP_ARM, StopArm.Response(success=True))
    graph.wait_until(lambda: node.count_services(shared.STOP_ARM.name))
    node.operator.stop("browser 3")
    graph.wait_until(lambda: asked)
    assert "browser 3" in asked[0].reason
    graph.probe.send(shared.ARM_STATE, ArmState(is_stopped=True, reason=asked[0].reason))
    graph.wait_until(lambda: node.operator.condition.can_resume)
    assert not node.operator.condition.can_stop


def test_pause_asks_the_simulator(graph: Graph, node: LiveNode) -> None:
    asked = serve(graph, shared.SET_SIMULATION_STATE, SetSimulationState.Response())
    graph.wait_until(lambda: node.count_services(shared.SET_SIMULATION_STATE.name))
    node.operator.set_paused(True, "browser 1")
    graph.wait_until(lambda: asked)
    assert asked[0].state.state == SimulationState.STATE_PAUSED


def test_a_reset_that_fails_is_said_and_sends_no_goal(graph: Graph, node: LiveNode) -> None:
    asked = serve(graph, contracts.RESET, ResetScene.Response(success=False, message="no such scene"))
    graph.wait_until(lambda: node.count_services(contracts.RESET.name))
    node.operator.start("browser 1")
    assert not node.operator.condition.can_start  # not twice
    with pytest.raises(PackError, match="starting"):
        node.operator.start("browser 2")
    graph.wait_until(lambda: asked and "no such scene" in node.page.log.text)
    graph.wait_until(lambda: node.operator.condition.can_start)


def test_a_goal_in_progress_can_be_cancelled_and_no_other_started(graph: Graph, node: LiveNode) -> None:
    graph.probe.send(shared.NODE_STATUS, NodeStatus(name="mpc", state=NodeStatus.BUSY))
    graph.wait_until(lambda: node.operator.condition.can_cancel)
    with pytest.raises(PackError, match="in progress"):
        node.operator.start("browser 1")


def test_an_upload_that_is_no_scene_is_refused_with_the_reason(graph: Graph, node: LiveNode) -> None:
    choice = node.form.file
    for content in (b"objects: [", b"\xff\xfe", b"x" * 2_000_000):
        choice.take(SimpleNamespace(name="mine.yaml", content=content))
    assert node.page.log.text.count("upload refused") == 3
    choice.take(
        SimpleNamespace(
            name="mine.yaml", content=config_path("scenarios", "packing", "example.yaml").read_bytes()
        )
    )
    assert choice.name == "mine.yaml (uploaded)"
    assert "new_object" in choice.text


def test_a_container_to_be_filled_is_emptied_first(graph: Graph, node: LiveNode) -> None:
    node.form.task.value = FILL
    asked = serve(graph, contracts.RESET, ResetScene.Response(success=False, message="seen"))
    graph.wait_until(lambda: node.count_services(contracts.RESET.name))
    node.operator.start("browser 1")
    graph.wait_until(lambda: asked)
    start = wanted_scene(asked[0], packing_cell())
    assert not start.objects
    assert start.new_object.pose is not None  # handed over beside the container, not at the pump
    action, goal = node.form.goal()
    assert action is contracts.FILL_CONTAINER
    assert len(parse_list(goal.list, "goal", packing_cell()).objects) == 8


def test_weights_of_the_cost_are_those_of_the_controller_and_can_be_changed(
    graph: Graph, node: LiveNode
) -> None:
    assert node.sliders is not None
    sliders = node.sliders.sliders
    mpc = graph.start(MpcNode)
    graph.wait_until(lambda: "obstacle" in sliders)
    assert (sliders["force"].value, sliders["force"].min, sliders["force"].max) == (1.0, 0.0, 10.0)
    node.sliders.set("force", 2.5, "browser 1")
    graph.wait_until(lambda: "browser 1: force x 2.5, counts from the next goal on" in node.page.log.text)
    assert mpc.get_parameter("weight_factors.force").value == 2.5
    # as others change it, such as `ros2 param set`
    mpc.set_parameters_atomically([Parameter("weight_factors.yaw", value=3.0)])
    graph.wait_until(lambda: sliders["yaw"].value == 3.0 and sliders["force"].value == 2.5)
    node.sliders.set("yaw", 99.0, "browser 1")
    graph.wait_until(lambda: "weight_factors.yaw" in node.page.log.text)
    assert mpc.get_parameter("weight_factors.yaw").value == 3.0


def test_an_unknown_cell_is_refused(graph: Graph) -> None:
    with pytest.raises(ConfigError, match="juggling"):
        graph.start(LiveNode, cell="juggling", port=free_port())
