"""What the controller hears of the force sensor, and of its zero."""

from __future__ import annotations

from functools import partial

import numpy as np
from geometry_msgs.msg import WrenchStamped
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


def test_forces_go_with_the_joints_that_were_measured_after_them(graph: Graph) -> None:
    mailbox = Mailbox(graph.start(partial(CellNode, "mpc")), JOINTS)
    graph.connect(contracts.JOINT_STATES, contracts.SCENE, contracts.WRENCH)

    def forces(time: float, *stamps: float) -> list[float]:
        graph.probe.send(contracts.SCENE, to_scene(SceneState(time, {})))
        sample = JointSample(time, np.zeros(7), np.zeros(7), np.zeros(7))
        graph.probe.send(contracts.JOINT_STATES, to_joint_state(sample, JOINTS))
        for stamp in stamps:
            message = WrenchStamped(header=Header(stamp=to_stamp(stamp)))
            message.wrench.force.x = stamp
            graph.probe.send(contracts.WRENCH, message)
        graph.wait_until(lambda: mailbox.time == time and (not stamps or mailbox.force[0] == stamps[-1]))
        return list(mailbox.observe(np.inf).forces[:, 0])

    # One of a clock of its own does not wait for its time.
    assert forces(5.0, 4.996, 5.0, 5.004, 9.0, 5.008) == [4.996, 5.0, 9.0]
    assert forces(5.03) == [5.004, 5.008]
