"""A shift through the nodes: places are asked for, the conveyor is run, goals are refused with the reason."""

from __future__ import annotations

import numpy as np
import pytest
from pack_interfaces.action import RunShift
from pack_interfaces.srv import PlanPlace, ReplacePallet, ResetCell
from std_srvs.srv import Trigger

from integration.harness import Graph
from integration.palletizing.test_fsm_node import tell
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PALLET, SECOND_PALLET, palletizing_cell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.next_place import NextStep, PlaceQuestion, StandingPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.ros.contracts import motion
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.palletizing import from_answer, from_cloud, to_question, to_simulated
from pack_core.rotations import Pose
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.layout_node import LayoutNode
from pack_planner.layout.online_planner import OnlineConfig
from pack_planner.layout.place_answers import PlaceAnswers
from pack_sim.palletizing.pallet_sim_node import PalletSimNode
from pallet_fsm.fsm_node import PalletFsmNode

CELL = palletizing_cell("shift")


def test_the_place_service_answers_as_the_planner_does(graph: Graph) -> None:
    node = graph.start(LayoutNode, preset="shift")
    low = PlacedBox("low", np.zeros(3), np.array([0.4, 0.3, 0.2]), 5.0, max_load=0.0)
    tea = Item(
        id="7-tea", article="tea", size=(0.4, 0.3, 0.2), weight=5.0, this_side_up=True, max_pressure=2.0
    )
    question = PlaceQuestion(
        3, (StandingPallet(PALLET, (low,)), StandingPallet(SECOND_PALLET)), (), (tea,), 2
    )
    response = graph.call(contracts.PLAN_PLACE, to_question(question))
    assert response.success, response.message
    served = from_answer(response, 3)
    own = PlaceAnswers(CELL, OnlineConfig(), InsertionConfig()).answer(question)
    assert (served.step, served.item, served.pallet) == (NextStep.PLACE, own.item, own.pallet)
    assert served.plan is not None
    assert own.plan is not None
    assert served.plan.placed.lower.tolist() == own.plan.placed.lower.tolist()

    unknown = PlanPlace.Request(pallets=to_question(question).pallets)
    unknown.pallets[0].place = "third"
    refused = graph.call(contracts.PLAN_PLACE, unknown)
    assert refused.message == "place is 'third'; allowed: pallet, second_pallet"
    assert node.health.counts["refused /plan_place"] == 1


def test_the_conveyor_brings_a_box_and_a_pallet_is_replaced(graph: Graph) -> None:
    told = (contracts.INFEED_STATE, contracts.PALLET_PLACES, contracts.PICKING_SCAN, contracts.BOXES)
    graph.probe.listen(*told)
    sim = graph.start(
        PalletSimNode, **{"preset": "shift", "real_time_factor": 0.0, "camera.width": 640, "swap_time": 600.0}
    )
    standing = to_simulated(BoxBody("1-tea", (0.4, 0.3, 0.2), 5.0), Pose(np.array([0.5, 0.4, 0.244])))
    request = ResetCell.Request(seed=1000, standing=[standing], come=["1-instant meal-00104572"])
    assert graph.call(contracts.RESET, request).success
    assert graph.call(contracts.SEND_BOX, Trigger.Request()).success
    graph.wait_until(lambda: bool(graph.probe.last(contracts.INFEED_STATE).box), 60.0)
    came = graph.probe.last(contracts.INFEED_STATE)
    assert (came.number, came.box.split("-")[0]) == (1, "1" if came.box not in request.come else "2")
    assert "1-tea" in {box.name for box in sim.simulator.boxes}

    assert graph.call(contracts.SCAN_PICKING, Trigger.Request()).success
    graph.wait_until(lambda: graph.probe.last(contracts.PICKING_SCAN) is not None)
    assert len(from_cloud(graph.probe.last(contracts.PICKING_SCAN), "picking_table").points) > 1000

    wrong = graph.call(contracts.REPLACE_PALLET, ReplacePallet.Request(place="table", boxes=[]))
    assert wrong.message == "place is 'table'; allowed: pallet, second_pallet"
    assert graph.call(contracts.REPLACE_PALLET, ReplacePallet.Request(place=PALLET, boxes=["1-tea"])).success
    graph.wait_until(lambda: list(graph.probe.last(contracts.PALLET_PLACES).away) == [PALLET])
    assert "1-tea" not in {box.name for box in sim.simulator.boxes}


@pytest.mark.parametrize(
    ("preset", "fields", "reason"),
    [
        ("rigid", {"boxes": 3}, "no conveyor under the preset 'rigid'"),
        ("shift", {"boxes": 3, "folder": ""}, "the goal has no `folder`"),
        ("shift", {"boxes": 0}, "boxes is 0; allowed: 1 or more"),
        ("shift", {"resume": True}, "there is no such file"),
    ],
)
def test_a_shift_that_cannot_be_is_refused_in_words(graph: Graph, tmp_path, preset, fields, reason) -> None:
    graph.start(LayoutNode, preset=preset)
    node = graph.start(PalletFsmNode, watched=["layout"], preset=preset)
    graph.connect(motion.MOTION_STATUS, contracts.GRIPPER_STATE)
    tell(graph)
    graph.wait_until(lambda: not node.waits_for)
    goal = RunShift.Goal(**{"folder": str(tmp_path / "shift"), **fields})
    assert reason in graph.result_of(graph.send_goal(contracts.RUN_SHIFT, goal)).message
