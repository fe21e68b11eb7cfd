"""The machine's node: orders that are refused before anything moves, and a halt."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest
from pack_interfaces.action import Palletize
from pack_interfaces.msg import ArmState
from rclpy.task import Future
from std_msgs.msg import String

from integration.harness import Graph
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.paths import config_path
from pack_core.ros.contracts import motion as motion_contracts
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.markers import GOALS, VERTICES
from pack_core.ros.messages.motion import to_status
from pack_core.ros.messages.palletizing import to_gripper_state
from pack_core.rotations import POINTING_DOWN, Pose
from pack_planner.layout.layout_node import LayoutNode
from pallet_fsm.fsm_node import PalletFsmNode

ORDER = config_path("orders", "order_03.json")
FAULT_TIME = 0.5
"""Silence of a node that ends an order [s]."""


@pytest.fixture
def fsm(graph: Graph) -> PalletFsmNode:
    """The machine and the layout; the probe speaks for arm and gripper."""
    graph.probe.listen(contracts.PALLET_STATE, motion_contracts.MOTION_TARGET, contracts.RESULT)
    graph.start(LayoutNode)
    node = graph.start(PalletFsmNode, watched=["layout"], fault_time=FAULT_TIME)
    graph.connect(motion_contracts.MOTION_STATUS, contracts.GRIPPER_STATE)
    return node


def tell(graph: Graph, time: float = 1.0) -> None:
    """Speak for arm and gripper, once."""
    X_WT = Pose(np.array([0.0, 0.5, 2.0]), POINTING_DOWN)
    status = MotionStatus(time, 0, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", X_WT)
    graph.probe.send(contracts.GRIPPER_STATE, to_gripper_state(time, GripState(reason=ASKED)))
    graph.probe.send(motion_contracts.MOTION_STATUS, to_status(status))


def accepted(graph: Graph, fsm: PalletFsmNode, **fields: str) -> object:
    """The handle of a goal that is taken, once arm and gripper have been heard."""
    tell(graph)
    graph.wait_until(lambda: not fsm.waits_for)
    return graph.send_goal(contracts.PALLETIZE, Palletize.Goal(**fields))


def test_an_order_before_the_arm_was_heard_is_not_taken(graph: Graph, fsm: PalletFsmNode) -> None:
    assert "nothing heard of arm" in graph.refusal(contracts.PALLETIZE, Palletize.Goal(file=str(ORDER)))


def test_an_order_without_a_layout_service_is_not_taken(graph: Graph) -> None:
    graph.probe.listen(shared.DIAGNOSTICS)
    graph.start(PalletFsmNode)
    graph.connect(motion_contracts.MOTION_STATUS, contracts.GRIPPER_STATE)

    def says_why() -> bool:
        tell(graph)
        graph.refusal(contracts.PALLETIZE, Palletize.Goal(file=str(ORDER)))
        mail = graph.probe.mail[shared.DIAGNOSTICS.name]
        return any("is layout up?" in message.status[0].message for message in mail)

    graph.wait_until(says_why)


def test_a_node_that_dies_while_the_layout_is_planned_ends_the_order(
    graph: Graph, fsm: PalletFsmNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fsm._layout, "call_async", lambda _: Future(executor=fsm.executor))
    handle = accepted(graph, fsm, file=str(ORDER))
    fsm.on_peer("sim", is_alive=False)
    assert graph.result_of(handle).message == "node 'sim' is silent"
    fsm.on_peer("sim", is_alive=True)
    graph.send_goal(contracts.PALLETIZE, Palletize.Goal(file=str(ORDER)))
    graph.wait_until(lambda: fsm.is_busy)


def test_an_order_whose_layout_never_comes_can_be_cancelled(
    graph: Graph, fsm: PalletFsmNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fsm._layout, "call_async", lambda _: Future(executor=fsm.executor))
    handle = accepted(graph, fsm, file=str(ORDER))
    graph.wait_until(lambda: fsm.is_busy)
    handle.cancel_goal_async()
    assert graph.result_of(handle).message == "canceled on request"
    assert not fsm.is_busy


def spoiled(change: str) -> str:
    order = json.loads(ORDER.read_text())
    first, second = order["boxes"]
    if change == "overlap":
        second["position"] = first["position"]
    elif change == "twice":
        second["id"] = first["id"]
    elif change == "orient_id":
        first["orient_id"] = 9
    elif change == "weight":
        first["weight"] = 40.0
    elif change == "outside":
        first["position"] = [0.9, 0.0, 0.0]
    else:
        first["dims"] = [-0.4, 0.3, 0.2]
    order.pop("total_weight")
    return json.dumps(order)


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"order": "no JSON"}, "JSON"),
        ({}, "the goal holds no order"),
        ({"file": "/nowhere/order.json"}, "/nowhere/order.json: no such file"),
        ({"file": "/dev"}, "/dev: cannot be read: Is a directory"),
        ({"order": spoiled("overlap")}, "00101323-5"),
        ({"order": spoiled("twice")}, "00102400-4"),
        ({"order": spoiled("orient_id")}, "orient_id"),
        ({"order": spoiled("size")}, "dims"),
        ({"order": spoiled("outside")}, "it ends at"),
        ({"order": spoiled("weight")}, "40 kg, held from above, make a coaxial force of 712.4 N"),
        ({"file": str(ORDER), "profile": "quick"}, "thesis, blended"),
    ],
    ids=[
        "no JSON",
        "nothing",
        "no file",
        "folder",
        "overlap",
        "twice",
        "orient_id",
        "size",
        "outside",
        "weight",
        "profile",
    ],
)
def test_a_wrong_order_ends_with_the_reason_and_nothing_moves(
    graph: Graph, fsm: PalletFsmNode, fields: dict[str, str], reason: str
) -> None:
    result = graph.result_of(accepted(graph, fsm, **fields))
    assert not result.success
    assert reason in result.message
    assert graph.probe.mail[motion_contracts.MOTION_TARGET.name] == []
    assert graph.probe.mail[contracts.PALLET_STATE.name] == []


@pytest.mark.parametrize("number", range(1, 5))
def test_plans_that_would_not_stand_are_refused_with_the_boxes_named(
    graph: Graph, fsm: PalletFsmNode, number: int
) -> None:
    file = config_path("orders", "stress", f"order_{number:02}.json")
    result = graph.result_of(accepted(graph, fsm, file=str(file)))
    assert not result.success
    names = [box["id"] for box in json.loads(file.read_text())["boxes"]]
    assert any(name in result.message for name in names)


def test_a_machine_that_is_left_alone_with_its_box_stops_and_says_why(
    graph: Graph, fsm: PalletFsmNode
) -> None:
    handle = accepted(graph, fsm, file=str(ORDER))
    graph.wait_until(lambda: graph.probe.mail[contracts.PALLET_STATE.name] or tell(graph))
    first = graph.probe.mail[contracts.PALLET_STATE.name][0]
    assert (first.state, first.box) == ("0 spawn", "00102400-4")
    fsm.on_peer("sim", is_alive=False)
    graph.wait_until(lambda: graph.probe.mail[contracts.RESULT.name])
    assert graph.result_of(handle).message == "node 'sim' is silent"
    report = json.loads(graph.probe.last(contracts.RESULT).data)
    assert report["reason"] == "node 'sim' is silent"
    assert isinstance(graph.probe.last(contracts.RESULT), String)


def test_the_places_of_an_order_s_boxes_are_shown(graph: Graph, fsm: PalletFsmNode) -> None:
    graph.probe.listen(motion_contracts.GOAL_MARKERS)
    accepted(graph, fsm, file=str(ORDER))
    graph.wait_until(lambda: graph.probe.last(motion_contracts.GOAL_MARKERS) or tell(graph))
    shown = graph.probe.last(motion_contracts.GOAL_MARKERS).markers
    _, *markers = (marker for marker in shown if marker.ns == GOALS)
    boxes = {marker.text: cube for cube, marker in zip(markers[::2], markers[1::2], strict=True)}
    order = {box["id"]: box for box in json.loads(ORDER.read_text())["boxes"]}
    assert boxes.keys() == order.keys()
    assert [len(dots.points) for dots in shown if dots.ns == VERTICES] == [8] * len(boxes)
    deck = palletizing_cell().pallet.X_WP.p[2]
    lowest = min(cube.pose.position.z - 0.5 * cube.scale.z for cube in boxes.values())
    assert lowest == pytest.approx(deck, abs=1e-6)


def test_an_order_is_refused_while_the_gripper_holds_a_box(graph: Graph, fsm: PalletFsmNode) -> None:
    tell(graph)
    graph.probe.send(contracts.GRIPPER_STATE, to_gripper_state(1.0, GripState(held="17")))
    graph.wait_until(lambda: "holds" in fsm.refusal(Palletize.Goal()))
    assert "holds '17'" in graph.refusal(contracts.PALLETIZE, Palletize.Goal(file=str(ORDER)))
    tell(graph, 2.0)
    graph.wait_until(lambda: not fsm.refusal(Palletize.Goal()))


def test_a_stop_of_the_arm_ends_the_order_safely(graph: Graph, fsm: PalletFsmNode) -> None:
    handle = accepted(graph, fsm, file=str(ORDER))
    graph.wait_until(lambda: graph.probe.mail[contracts.PALLET_STATE.name] or tell(graph))
    graph.connect(shared.ARM_STATE)
    graph.probe.send(shared.ARM_STATE, ArmState(is_stopped=True, reason="a button", stops=1))
    result = graph.result_of(handle)
    assert (result.success, result.message) == (False, "the arm was stopped: a button")
    graph.wait_until(lambda: graph.probe.last(contracts.PALLET_STATE).reason == result.message)
    graph.wait_until(lambda: graph.probe.last(motion_contracts.MOTION_TARGET))
    assert not graph.probe.last(motion_contracts.MOTION_TARGET).segments


def test_a_node_that_is_soon_heard_again_costs_nothing(graph: Graph, fsm: PalletFsmNode) -> None:
    handle = accepted(graph, fsm, file=str(ORDER))
    graph.wait_until(lambda: graph.probe.mail[contracts.PALLET_STATE.name] or tell(graph))
    fsm.on_peer("vision", is_alive=False)
    fsm.on_peer("vision", is_alive=True)
    until = time.monotonic() + 2.0 * FAULT_TIME
    graph.wait_until(lambda: time.monotonic() > until)
    assert not graph.probe.mail[contracts.RESULT.name]
    handle.cancel_goal_async()
    graph.wait_until(lambda: graph.probe.mail[contracts.RESULT.name] or tell(graph, 2.0))
