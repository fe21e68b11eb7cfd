"""Two cells in one ROS domain, each in a namespace: nothing of one reaches the other."""

from __future__ import annotations

from pathlib import Path

from pack_interfaces.action import Palletize
from pack_interfaces.srv import StopArm
from rclpy.node import Node

from integration.blocks.test_blocks_nodes import TEXT
from integration.goal_rig import ACTION, Waiter
from integration.harness import Graph
from pack_bringup.graph.running import cell_nodes_here
from pack_bringup.ros.goal_client import GoalClient
from pack_bringup.ros.status_listener import StatusListener
from pack_core.joints import JointSample
from pack_core.motion.moves import JointMove
from pack_core.motion.moves import Path as MovePath
from pack_core.motion.target import MotionTarget
from pack_core.robots.ur10e import JOINTS
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.joints import from_joint_state
from pack_core.ros.messages.motion import to_target
from pack_core.ros.node import CellNode
from pack_motion.motion_node import MotionNode
from pack_sim.blocks.blocks_sim_node import BlocksSimNode

SIDES = ("/left", "/right")
IN_NAMESPACE = tuple(f"{side}/" for side in SIDES)


class Onlooker(CellNode):
    """Keeps what one of the cells says of its arm, and asks it."""

    may_be_repeated = True

    def __init__(self, **kwargs: object) -> None:
        super().__init__("onlooker", **kwargs)
        self.joints: JointSample | None = None
        self.is_stopped = False
        self.listen(motion.JOINT_STATES, self._on_joints)
        self.listen(shared.ARM_STATE, self._on_arm)
        self.targets = self.advertise(motion.MOTION_TARGET)
        self.stop = self.create_client(StopArm, shared.STOP_ARM.name)

    def _on_joints(self, message: object) -> None:
        self.joints = from_joint_state(message, JOINTS)

    def _on_arm(self, message: object) -> None:
        self.is_stopped = message.is_stopped


def start(graph: Graph, make: type[Node], side: str, **parameters: object) -> Node:
    """A node of one of the cells."""
    return graph.start(lambda **kwargs: make(namespace=side, **kwargs), **parameters)


def topics_outside(probe: Node) -> set[str]:
    """Topics of nodes in the namespaces that are not in theirs.

    Commands that look for cells on this machine visit all domains; what they ask for is not counted.
    """
    topics = {name for name, _ in probe.get_topic_names_and_types() if not name.startswith(IN_NAMESPACE)}
    return {
        name
        for name in topics
        for end in (*probe.get_publishers_info_by_topic(name), *probe.get_subscriptions_info_by_topic(name))
        if end.node_namespace in SIDES
    }


def test_a_move_and_a_stop_of_one_cell_are_not_heard_in_the_other(graph: Graph, tmp_path: Path) -> None:
    file = tmp_path / "problem.yaml"
    file.write_text(TEXT)
    lookers = {side: start(graph, Onlooker, side) for side in SIDES}
    for side in SIDES:
        start(graph, BlocksSimNode, side, problem=str(file), real_time_factor=0.3)
        start(graph, MotionNode, side, cell="blocks")
    graph.wait_until(lambda: all(looker.joints for looker in lookers.values()), 60.0)
    graph.wait_until(lambda: all(looker.targets.get_subscription_count() for looker in lookers.values()))
    with StatusListener(graph.context.get_domain_id(), "/left") as listener:

        def heard() -> bool:
            graph.spin_once(0.01)
            return not listener.unready(["sim", "motion"])

        assert listener.spin_until(heard, 60.0)
    # A node is known on its machine from the first turn of its executor on.
    graph.wait_until(lambda: cell_nodes_here(graph.context.get_domain_id(), "/right") == {"sim", "motion"})
    left, right = lookers["/left"], lookers["/right"]
    rest = right.joints.q
    goal = left.joints.q.copy()
    goal[0] += 0.1
    left.targets.publish(
        to_target(MotionTarget(1, MovePath((JointMove(goal),)), is_checked=False), left.joints.time)
    )
    graph.wait_until(lambda: abs(left.joints.q[0] - goal[0]) < 2e-3, 60.0)
    assert abs(right.joints.q - rest).max() < 1e-3
    graph.wait_until(right.stop.service_is_ready)
    right.stop.call_async(StopArm.Request(reason="test"))
    graph.wait_until(lambda: right.is_stopped)
    assert not left.is_stopped
    assert topics_outside(graph.probe) == {"/parameter_events", "/rosout"}


def test_a_goal_reaches_the_cell_of_its_namespace(graph: Graph) -> None:
    waiters = [start(graph, Waiter, side) for side in SIDES]
    goal = Palletize.Goal(order="one")
    client = graph.start(lambda **kwargs: GoalClient(ACTION, goal, [], namespace="/right", **kwargs))

    def pursued() -> bool:
        client.pursue()
        return bool(waiters[1].started)

    graph.wait_until(pursued)
    assert waiters[0].started == 0
    waiters[1].end(True, "")
    graph.wait_until(lambda: client.result is not None)
