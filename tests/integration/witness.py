"""A probe that sends goals and watches what the arm and the nodes' health make of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from pack_interfaces.action import PackObject

from integration.harness import Graph
from integration.packing.sim_rig import joint_samples, newest_joints, speeds
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared

AT_REST = 0.02
"""[rad/s]"""
IN_MOTION = 0.2
"""[rad/s]"""


class Witness:
    """Stands beside a cell, whoever runs it."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.feedback: list[PackObject.Feedback] = []
        graph.probe.listen(
            contracts.JOINT_STATES,
            contracts.SCENE,
            contracts.MPC_STATUS,
            contracts.RESULT,
            shared.DIAGNOSTICS,
        )

    def pack(self, seed: int = 0, timeout: float = 0.0) -> Any:
        """Send a goal; its handle."""
        goal = PackObject.Goal(method="pack_it_in", seed=seed, timeout=timeout)
        return self.graph.send_goal(
            contracts.PACK_OBJECT, goal, feedback=lambda message: self.feedback.append(message.feedback)
        )

    def wait_for_motion(self) -> None:
        """Until the arm follows a plan."""
        self.graph.wait_until(lambda: speeds(newest_joints(self.graph)).max() > IN_MOTION, timeout=30.0)

    def wait_past(self, time: float) -> None:
        """Until joint states of a later time have been heard [s]."""
        self.graph.wait_until(lambda: newest_joints(self.graph).time > time)

    def time_to_rest(self, after: float) -> float:
        """Simulated time [s] from `after` to the last joint state in motion."""
        samples = joint_samples(self.graph, after)
        moving = [sample.time for sample in samples if speeds(sample).max() > AT_REST]
        return float(np.max(moving, initial=after)) - after

    def status_of(self, name: str) -> DiagnosticStatus:
        """A node's newest health."""
        messages = self.graph.probe.mail[shared.DIAGNOSTICS.name]
        statuses = [status for message in messages for status in message.status if status.name == name]
        return statuses[-1] if statuses else DiagnosticStatus()

    def counts_of(self, name: str) -> dict[str, str]:
        """What a node has counted, by what it was."""
        return {item.key: item.value for item in self.status_of(name).values}

    def wait_for_report(self, name: str, text: str) -> None:
        """Until a node's health says so."""
        self.graph.wait_until(lambda: text in self.status_of(name).message)
