"""The pump on command."""

from __future__ import annotations

from pack_interfaces.srv import GripperCommand

from integration.harness import Graph
from integration.packing.sim_rig import start_sim
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.scene import from_scene
from pack_core.states import ObjectState
from pack_sim.packing.sim_node import PackingSimNode

HELD = "passata"


def command_gripper(graph: Graph, sim: PackingSimNode, close: bool) -> GripperCommand.Response:
    """The response, once a state of a later moment has been heard."""
    response = graph.call(contracts.GRIPPER_COMMAND, GripperCommand.Request(close=close))
    since = sim.simulator.time
    graph.wait_until(lambda: from_stamp(graph.probe.last(contracts.GRIPPER_STATE).header.stamp) > since)
    return response


def held_object(graph: Graph) -> ObjectState:
    return from_scene(graph.probe.last(contracts.TRUTH)).objects[HELD]


def test_the_gripper_lets_go_on_command_and_says_why(graph: Graph) -> None:
    sim = start_sim(graph, 0.0)
    height = held_object(graph).X_WO.p[2]
    assert command_gripper(graph, sim, close=False).success
    state = graph.probe.last(contracts.GRIPPER_STATE)
    assert (state.is_closed, state.object, state.release_reason) == (False, "", "asked to open")
    graph.wait_until(lambda: held_object(graph).X_WO.p[2] < height - 0.05)


def test_the_gripper_closes_only_on_an_object_under_the_cup(graph: Graph) -> None:
    sim = start_sim(graph, 0.05)
    assert command_gripper(graph, sim, close=False).success
    assert command_gripper(graph, sim, close=True).success
    assert graph.probe.last(contracts.GRIPPER_STATE).is_closed
    assert command_gripper(graph, sim, close=False).success
    graph.wait_until(lambda: held_object(graph).v_WO_W[2] < -0.5)
    response = command_gripper(graph, sim, close=True)
    assert not response.success
    assert "degrees off the cup; allowed: 5 mm and 2 degrees" in response.message
    assert not graph.probe.last(contracts.GRIPPER_STATE).is_closed
