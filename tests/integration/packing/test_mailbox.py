"""What the controller hears of the force sensor's zero."""

from __future__ import annotations

from functools import partial

import numpy as np
from std_msgs.msg import Header

from integration.harness import Graph
from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.scene import to_scene
from pack_core.ros.node import CellNode
from pack_core.states import SceneState
from pack_mpc.ros.mailbox import Mailbox

JOINTS = packing_cell().robot.arm.joints


def test_when_the_sensor_was_set_to_zero_is_known_once_it_is_said_and_not_ahead_of_time(graph: Graph) -> None:
    mailbox = Mailbox(graph.start(partial(CellNode, "mpc")), JOINTS)
    graph.connect(contracts.JOINT_STATES, contracts.SCENE, contracts.WRENCH_ZEROED)

    def zeroed(time: float) -> float | None:
        graph.probe.send(contracts.SCENE, to_scene(SceneState(time, {})))
        sample = JointSample(time, np.zeros(7), np.zeros(7), np.zeros(7))
        graph.probe.send(contracts.JOINT_STATES, to_joint_state(sample, JOINTS))
        graph.wait_until(lambda: mailbox.time == time)
        return mailbox.observe(np.inf).zeroed

    assert zeroed(5.0) is None
    graph.probe.send(contracts.WRENCH_ZEROED, Header(stamp=to_stamp(4.5)))
    graph.wait_until(lambda: zeroed(6.0) == 4.5)
    assert zeroed(1.0) is None  # the driver has begun anew, and has not said so yet
