"""What was seen before the simulator began anew counts no more: its time is then ahead of the clock."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from rosgraph_msgs.msg import Clock

from block_fsm.executor_config import RequestTimeouts
from block_fsm.ros.request_runner import RequestRunner
from integration.harness import Graph
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.planar import PlanarPose
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.grip import GripState
from pack_core.palletizing.ports import PalletObservation
from pack_core.palletizing.scanner import PlaceScan
from pack_core.ros.contracts import blocks, motion, palletizing, shared
from pack_core.ros.messages.blocks import to_sighting
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.motion import to_status
from pack_core.ros.messages.palletizing import to_cloud, to_detection, to_gripper_state
from pack_core.ros.node import CellNode
from pack_core.rotations import Pose
from pallet_fsm.ros.cell_ports import CellPorts

BEFORE, AFTER = 50.0, 2.0
IDENTITY = Pose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


class WatchingNode(CellNode):
    """A node that does nothing by itself."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__("watching", **kwargs)


@pytest.fixture
def runner(graph: Graph) -> Iterator[RequestRunner]:
    node = graph.start(WatchingNode, use_sim_time=True)
    runner = RequestRunner(node, RequestTimeouts(), lambda: None, lambda _: None)
    yield runner
    runner.end()


@pytest.fixture
def ports(graph: Graph) -> Iterator[CellPorts]:
    node = graph.start(WatchingNode, use_sim_time=True)
    ports = CellPorts(node, lambda: None, lambda _: None, palletizing_cell())
    yield ports
    ports.end()


def seen(ports: CellPorts) -> PalletObservation:
    """What is known once motion and gripper were heard."""
    observation = ports.observe()
    assert observation is not None
    return observation


def tick(graph: Graph, time: float) -> None:
    graph.probe.send(shared.CLOCK, Clock(clock=to_stamp(time)))


def test_a_sighting_from_before_the_simulator_began_anew_answers_no_look(
    graph: Graph, runner: RequestRunner
) -> None:
    graph.connect(shared.CLOCK, blocks.BLOCK_POSES)
    tick(graph, BEFORE)
    seen = BlockSighting(BEFORE - 0.2, {"b1": PlanarPose(0.6, 0.1, 0.0)})
    graph.probe.send(blocks.BLOCK_POSES, to_sighting(seen))
    graph.wait_until(lambda: runner.sighting is not None)
    tick(graph, AFTER)
    graph.wait_until(lambda: runner.time == AFTER)
    assert runner.sighting is None
    graph.probe.send(blocks.BLOCK_POSES, to_sighting(replace(seen, time=AFTER - 0.2)))
    graph.wait_until(lambda: runner.sighting is not None)


def test_a_detection_from_before_the_simulator_began_anew_answers_no_picture(
    graph: Graph, ports: CellPorts
) -> None:
    graph.connect(shared.CLOCK, palletizing.BOX_DETECTION, palletizing.GRIPPER_STATE, motion.MOTION_STATUS)
    tick(graph, BEFORE)
    graph.probe.send(palletizing.GRIPPER_STATE, to_gripper_state(BEFORE, GripState()))
    status = MotionStatus(BEFORE, 1, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", IDENTITY)
    graph.probe.send(motion.MOTION_STATUS, to_status(status))
    detection = BoxDetection(
        BEFORE - 0.2, "box_1", DetectionStatus.NOT_FOUND, "nothing there", None, None, (0, 0)
    )
    graph.probe.send(palletizing.BOX_DETECTION, to_detection(detection))
    graph.wait_until(lambda: ports.observe() is not None and seen(ports).detection is not None)
    tick(graph, AFTER)
    graph.wait_until(lambda: ports.observe() is not None and seen(ports).time == AFTER)
    assert seen(ports).detection is None


def test_a_scan_from_before_the_simulator_began_anew_answers_no_look(graph: Graph, ports: CellPorts) -> None:
    graph.connect(shared.CLOCK, palletizing.PALLET_SCAN, palletizing.GRIPPER_STATE, motion.MOTION_STATUS)
    tick(graph, BEFORE)
    graph.probe.send(palletizing.GRIPPER_STATE, to_gripper_state(BEFORE, GripState()))
    status = MotionStatus(BEFORE, 1, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", IDENTITY)
    graph.probe.send(motion.MOTION_STATUS, to_status(status))
    scan = PlaceScan(BEFORE - 0.2, "pallet", np.array([[0.0, 0.0, 4.0]]))
    graph.probe.send(palletizing.PALLET_SCAN, to_cloud(scan))
    graph.wait_until(lambda: ports.observe() is not None and seen(ports).scans)
    tick(graph, AFTER)
    graph.wait_until(lambda: ports.observe() is not None and seen(ports).time == AFTER)
    assert not seen(ports).scans
