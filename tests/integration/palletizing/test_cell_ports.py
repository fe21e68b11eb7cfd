"""What the machine hears of the cell."""

from __future__ import annotations

from functools import partial

import numpy as np

from integration.harness import Graph
from pack_core.joints import JointSample
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.robots.kr210 import JOINTS
from pack_core.ros.contracts import motion as motion_contracts
from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.motion import to_status
from pack_core.ros.messages.palletizing import to_gripper_state
from pack_core.ros.node import CellNode
from pack_core.rotations import POINTING_DOWN, Pose
from pallet_fsm.ros.cell_ports import CellPorts


def test_every_measurement_of_the_joints_counts_once_however_seldom_somebody_looks(graph: Graph) -> None:
    """A scale that sees some of them takes jerks of the arm for weight."""
    node = graph.start(partial(CellNode, "fsm"))
    ports = CellPorts(node, lambda: None, lambda _: None, palletizing_cell())
    graph.connect(motion_contracts.MOTION_STATUS, motion_contracts.JOINT_STATES, contracts.GRIPPER_STATE)
    heard: list[float] = []

    def has_heard(number: int) -> bool:
        seen = ports.observe()
        heard.extend(sample.time for sample in seen.samples) if seen is not None else None
        return len(heard) >= number

    X_WT = Pose(np.array([0.0, 0.5, 2.0]), POINTING_DOWN)
    status = MotionStatus(1.0, 0, MotionState.IDLE, 0, "", 0.0, 0.0, 0.0, 0.0, 0, "", X_WT)
    graph.probe.send(contracts.GRIPPER_STATE, to_gripper_state(1.0, GripState(reason=ASKED)))
    graph.probe.send(motion_contracts.MOTION_STATUS, to_status(status))
    sent = [0.004 * k for k in range(1, 41)]
    for part in (sent[:30], sent[30:]):
        for time in part:
            sample = JointSample(time, np.zeros(6), np.zeros(6), np.zeros(6))
            graph.probe.send(motion_contracts.JOINT_STATES, to_joint_state(sample, JOINTS))
        graph.wait_until(lambda part=part: has_heard(sent.index(part[-1]) + 1))
    ports.end()
    np.testing.assert_allclose(heard, sent)
