"""The packing cell as separate processes, for tests that kill them one by one."""

from __future__ import annotations

import math
import signal
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

import numpy as np
from pack_interfaces.action import PackObject
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

from integration.harness import Graph
from pack_bringup.graph.graph import load_graph
from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.packing.goals import PackingJob
from pack_core.errors import BagError
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.rotations import Array
from pack_evaluation.bag import read_bag

EASY_SCENE = Path(__file__).with_name("easy_scene.yaml")
NODES = ("sim", "perception", "planner", "mpc", "recorder")
FACTOR = 0.25
"""Real-time factor: other tests run at the same time, and what a kill does is told in simulated time."""
START_TIMEOUT = 150.0
QUEUE = 10000
"""Joint states that may wait while the test does not spin; a gap would shift the time of a kill."""


class Cell:
    """The nodes' processes and a probe that hears what they say."""

    def __init__(self, graph: Graph, folder: Path) -> None:
        self.graph, self.folder = graph, folder
        folder.mkdir()
        demo = PackingJob(scene=EASY_SCENE, folder=folder, real_time_factor=FACTOR)
        self._log = (folder / "nodes.log").open("w")
        domain = str(graph.context.get_domain_id())
        self.processes = ProcessGroup(
            load_graph("packing").commands(demo.overrides()),
            environment={"ROS_DOMAIN_ID": domain}, output=self._log,
        )  # fmt: skip
        self._heard: list[tuple[float, int, float]] = []
        states, all_of_them = contracts.JOINT_STATES, QoSProfile(depth=QUEUE)
        graph.probe.create_subscription(states.type, states.name, self._hear, all_of_them)
        graph.probe.listen(shared.DIAGNOSTICS, contracts.RESULT)

    def __enter__(self) -> Self:
        self.processes.start()
        self.graph.wait_until_ready(*NODES, timeout=START_TIMEOUT)
        self.graph.wait_until(lambda: self._heard, START_TIMEOUT)
        return self

    def __exit__(self, *_: object) -> None:
        self.processes.stop()
        self._log.close()

    def start_goal(self) -> Any:
        """Send the goal."""
        return self.graph.send_goal(contracts.PACK_OBJECT, PackObject.Goal())

    def kill(self, name: str) -> int:
        """End a node without warning; the wall clock of it [ns since the epoch]."""
        killed = time.time_ns()
        self.processes.signal(name, signal.SIGKILL)
        return killed

    def simulated(self, wall_ns: int) -> float:
        """Simulated time at a wall clock [s]: of the last joint state heard that was sent by then."""
        return max(stamp for stamp, sent_ns, _ in self._heard if sent_ns <= wall_ns)

    def _hear(self, message: JointState, info: dict[str, int]) -> None:
        stamp, speed = from_stamp(message.header.stamp), max(abs(v) for v in message.velocity)
        self._heard.append((stamp, info["source_timestamp"], speed))

    @property
    def time(self) -> float:
        """Stamp of the newest joint state [s]."""
        return self._heard[-1][0]

    @property
    def speed(self) -> float:
        """Of the fastest joint, newest [rad/s]."""
        return self._heard[-1][2]

    def speeds(self) -> tuple[Array, Array]:
        """Times [s] and speeds of the fastest joint [rad/s], all that was heard."""
        times = np.array([stamp for stamp, _, _ in self._heard])
        return times, np.array([speed for _, _, speed in self._heard])

    def newest_recorded(self) -> float:
        """Stamp of the newest joint state in the bag [s]; minus infinity while there is none."""
        with suppress(BagError):
            messages = read_bag(self.folder).of(contracts.JOINT_STATES.name)
            return max((from_stamp(message.header.stamp) for message in messages), default=-math.inf)
        return -math.inf

    def has_reported(self, node: str, text: str) -> bool:
        """Whether a node's newest diagnostics are an error with this text in it."""
        mail = self.graph.probe.mail[shared.DIAGNOSTICS.name]
        status = [item for message in mail for item in message.status if item.name == node]
        return bool(status) and status[-1].level == b"\x02" and text in status[-1].message
