"""What was seen before the simulator began anew counts no more: its time is then ahead of the clock."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from rosgraph_msgs.msg import Clock

from block_fsm.ros.cell_state import CellState
from integration.harness import Graph
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.planar import PlanarPose
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus
from pack_core.palletizing.grip import GripState
from pack_core.palletizing.scanner import PlaceScan
from pack_core.ros.contracts import blocks, motion, palletizing, shared
from pack_core.ros.messages.blocks import to_sighting
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.motion import to_status
from pack_core.ros.messages.palletizing import to_cloud, to_detection, to_gripper_state
from pack_core.ros.node import CellNode
from pack_core.rotations import Pose
from pallet_fsm.ros.observer import Observer

BEFORE, AFTER = 50.0, 2.0
IDENTITY = Pose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


class WatchingNode(CellNode):
    """A node that does nothing by itself."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__("watching", **kwargs)


@pytest.fixture
def state(graph: Graph) -> Iterator[CellState]:
    state = CellState(graph.start(WatchingNode, use_sim_time=True), lambda: None)
    yield state
    state.end()


@pytest.fixture
def observer(graph: Graph) -> Iterator[Observer]:
    observer = Observer(graph.start(WatchingNode, use_sim_time=True), lambda: None)
    yield observer
    observer.end()


def tick(graph: Graph, time: float) -> None:
    graph.probe.send(shared.CLOCK, Clock(clock=to_stamp(time)))


def test_a_sighting_from_before_the_simulator_began_anew_answers_no_look(
    graph: Graph, state: CellState
) -> None:
    graph.connect(shared.CLOCK, blocks.BLOCK_POSES)
    tick(graph, BEFORE)
    seen = BlockSighting(BEFORE - 0.2, {"b1": PlanarPose(0.6, 0.1, 0.0)})
    graph.probe.send(blocks.BLOCK_POSES, to_sighting(seen))
    graph.wait_until(lambda: state.sighting is not None)
    tick(graph, AFTER)
    graph.wait_until(lambda: state.time == AFTER)
    assert state.sighting is None
    graph.probe.send(blocks.BLOCK_POSES, to_sighting(replace(seen, time=AFTER - 0.2)))
    graph.wait_until(lambda: state.sighting is not None)


def test_a_detection_from_before_the_simulator_began_anew_answers_no_picture(
    graph: Graph, observer: Observer
) -> None:
    graph.connect(shared.CLOCK, palletizing.BOX_DETECTION, palletizing.GRIPPER_STATE, motion.MOTION_STATUS)
    tick(graph, BEFORE)
    graph.probe.send(palletizing.GRIPPER_STATE, to_gripper_state(BEFORE, GripState()))
    status = MotionStatus(BEFORE, 1, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", IDENTITY)
    graph.probe.send(motion.MOTION_STATUS, to_status(status))
    seen = BoxDetection(BEFORE - 0.2, "box_1", DetectionStatus.NOT_FOUND, "nothing there", None, None, (0, 0))
    graph.probe.send(palletizing.BOX_DETECTION, to_detection(seen))
    graph.wait_until(lambda: observer.newest is not None and observer.newest.detection is not None)
    tick(graph, AFTER)
    graph.wait_until(lambda: observer.newest is not None and observer.newest.time == AFTER)
    assert observer.newest is not None
    assert observer.newest.detection is None


def test_a_scan_from_before_the_simulator_began_anew_answers_no_look(
    graph: Graph, observer: Observer
) -> None:
    graph.connect(shared.CLOCK, palletizing.PALLET_SCAN, palletizing.GRIPPER_STATE, motion.MOTION_STATUS)
    tick(graph, BEFORE)
    graph.probe.send(palletizing.GRIPPER_STATE, to_gripper_state(BEFORE, GripState()))
    status = MotionStatus(BEFORE, 1, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", IDENTITY)
    graph.probe.send(motion.MOTION_STATUS, to_status(status))
    scan = PlaceScan(BEFORE - 0.2, "pallet", np.array([[0.0, 0.0, 4.0]]))
    graph.probe.send(palletizing.PALLET_SCAN, to_cloud(scan))
    graph.wait_until(lambda: observer.newest is not None and observer.newest.scans)
    tick(graph, AFTER)
    graph.wait_until(lambda: observer.newest is not None and observer.newest.time == AFTER)
    assert observer.newest is not None
    assert not observer.newest.scans
