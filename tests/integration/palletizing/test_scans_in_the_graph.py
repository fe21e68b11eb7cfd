"""Scans in the graph: the simulator answers, and the machine's node ends an order when one shows a change."""

from __future__ import annotations

import numpy as np
import pytest
from pack_interfaces.action import Palletize
from std_srvs.srv import Trigger

from integration.harness import Graph
from integration.palletizing.pallet_rig import spawn, start_pallet_sim
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PALLET, palletizing_cell
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.palletizing.scanner import SCANNED, PlaceScan
from pack_core.paths import config_path
from pack_core.ros.contracts import motion as motion_contracts
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.motion import to_status
from pack_core.ros.messages.palletizing import from_cloud, to_cloud, to_gripper_state
from pack_core.rotations import POINTING_DOWN, Pose
from pack_planner.layout.layout_node import LayoutNode
from pallet_fsm.fsm_node import PalletFsmNode
from unit.pack_perception.scans.closed_form import box_on, scan_of

CELL = palletizing_cell()
ORDER = config_path("orders", "order_03.json")
SCANS = {
    PALLET: (contracts.SCAN_PALLET, contracts.PALLET_SCAN),
    "reorientation_table": (contracts.SCAN_TABLE, contracts.TABLE_SCAN),
}
BESIDE = Pose(np.array([-0.5, 1.2, 1.5]), POINTING_DOWN)
"""Of a tool that is near the pallet and hides nothing of it."""


@pytest.mark.parametrize("place", SCANNED)
def test_the_simulator_scans_a_place_when_it_is_asked_to(graph: Graph, place: str) -> None:
    start_pallet_sim(graph)
    trigger, points = SCANS[place]
    graph.probe.listen(points)
    assert graph.call(trigger, Trigger.Request()).success
    graph.wait_until(lambda: graph.probe.last(points))
    first = from_cloud(graph.probe.last(points), place)
    assert len(first.points) > 0.9 * len(CELL.scanner_rays(place))
    assert spawn(graph).success
    graph.wait_until(lambda: from_stamp(graph.probe.last(shared.CLOCK).clock) > first.time)
    graph.call(trigger, Trigger.Request())
    graph.wait_until(lambda: len(graph.probe.mail[points.name]) > 1)
    assert from_cloud(graph.probe.last(points), place).time > first.time


class Scanner:
    """Speaks for the simulator: arm and gripper stand still, and the pallet has on it what it is told."""

    def __init__(self, graph: Graph) -> None:
        self.graph, self.blocks, self.asked = graph, [*CELL.furniture], 0
        graph.probe.create_service(contracts.SCAN_PALLET.type, contracts.SCAN_PALLET.name, self._scan)

    def tell(self) -> None:
        """Send a status of arm and gripper."""
        now = self.graph.probe.get_clock().now().nanoseconds * 1e-9
        status = MotionStatus(now, 0, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", BESIDE)
        state = to_gripper_state(now, GripState(reason=ASKED))
        self.graph.probe.send(contracts.GRIPPER_STATE, state)
        self.graph.probe.send(motion_contracts.MOTION_STATUS, to_status(status))

    def _scan(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.asked += 1
        now = self.graph.probe.get_clock().now().nanoseconds * 1e-9
        scan = scan_of(CELL, PALLET, self.blocks, now)
        self.graph.probe.send(contracts.PALLET_SCAN, to_cloud(PlaceScan(now, PALLET, scan.points)))
        response.success = True
        return response


@pytest.fixture
def scanner(graph: Graph) -> Scanner:
    """The machine and the layout, and what speaks for the simulator."""
    scanner = Scanner(graph)
    graph.probe.listen(contracts.PALLET_STATE, contracts.RESULT, motion_contracts.MOTION_TARGET)
    graph.start(LayoutNode)
    node = graph.start(PalletFsmNode, watched=["layout"])
    graph.connect(motion_contracts.MOTION_STATUS, contracts.GRIPPER_STATE, contracts.PALLET_SCAN)
    graph.wait_until(lambda: not node.waits_for or scanner.tell())
    return scanner


def test_a_stranger_on_the_pallet_ends_the_order_with_what_is_seen(graph: Graph, scanner: Scanner) -> None:
    handle = graph.send_goal(contracts.PALLETIZE, Palletize.Goal(file=str(ORDER)))
    graph.wait_until(lambda: scanner.asked > 1 or scanner.tell())
    assert not graph.probe.mail[contracts.RESULT.name]
    stranger: Obstacle = box_on(CELL.pallet.deck_height, 0.1, 0.5, (0.2, 0.2, 0.15))
    scanner.blocks.append(stranger)
    graph.wait_until(lambda: graph.probe.mail[contracts.RESULT.name] or scanner.tell())
    result = graph.result_of(handle)
    assert not result.success
    assert result.message.startswith("seen on the pallet: something of 0.")
    states = [state.state for state in graph.probe.mail[contracts.PALLET_STATE.name]]
    assert states[-2:] == ["place changed", "safe stop"]
    assert not graph.probe.last(motion_contracts.MOTION_TARGET).segments
