"""The packing cell as separate processes, for tests that kill them one by one."""

from __future__ import annotations

import math
import signal
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

import numpy as np
from pack_interfaces.action import PackObject

from integration.harness import Graph
from pack_bringup.demo import Demo
from pack_bringup.graph import load_graph
from pack_bringup.processes import ProcessGroup
from pack_core.errors import BagError
from pack_core.evaluation.bag import read_bag
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.conversions import from_stamp
from pack_core.rotations import Array

EASY_SCENE = Path(__file__).with_name("easy_scene.yaml")
NODES = ("sim", "perception", "planner", "mpc", "recorder")
START_TIMEOUT = 60.0
CATCH_UP_TURNS = 50


class Cell:
    """The nodes' processes and a probe that hears what they say."""

    def __init__(self, graph: Graph, folder: Path) -> None:
        self.graph, self.folder = graph, folder
        folder.mkdir()
        demo = Demo("packing", folder, scene=EASY_SCENE)
        self._log = (folder / "nodes.log").open("w")
        domain = str(graph.context.get_domain_id())
        self.processes = ProcessGroup(
            load_graph("packing").commands(demo.overrides()),
            environment={"ROS_DOMAIN_ID": domain}, output=self._log,
        )  # fmt: skip
        graph.probe.listen(contracts.JOINT_STATES, shared.DIAGNOSTICS, contracts.RESULT)

    def __enter__(self) -> Self:
        self.processes.start()
        probe = self.graph.probe
        self.graph.wait_until(
            lambda: all(probe.count_publishers(f"/alive/{name}") for name in NODES), START_TIMEOUT
        )
        self.graph.wait_until(lambda: probe.last(contracts.JOINT_STATES), START_TIMEOUT)
        return self

    def __exit__(self, *_: object) -> None:
        self.processes.stop()
        self._log.close()

    def start_goal(self) -> Any:
        """Send the goal until it is accepted."""
        handles: list[Any] = []

        def is_accepted() -> bool:
            handles.append(self.graph.send_goal(contracts.PACK_OBJECT, PackObject.Goal(method="pack_it_in")))
            return bool(handles[-1].accepted)

        self.graph.wait_until(is_accepted, START_TIMEOUT)
        return handles[-1]

    def kill(self, name: str) -> float:
        """End a node without warning; the simulated time of it [s]."""
        self._catch_up()
        killed = self.time
        self.processes.signal(name, signal.SIGKILL)
        return killed

    def _catch_up(self) -> None:
        """Take all that has arrived, so that the newest stamp is that of now."""
        mail, seen = self.graph.probe.mail[contracts.JOINT_STATES.name], -1
        while len(mail) > seen:
            seen = len(mail)
            for _ in range(CATCH_UP_TURNS):
                self.graph.executor.spin_once(timeout_sec=0.0)

    @property
    def time(self) -> float:
        """Stamp of the newest joint state [s]."""
        return from_stamp(self.graph.probe.last(contracts.JOINT_STATES).header.stamp)

    @property
    def speed(self) -> float:
        """Of the fastest joint, newest [rad/s]."""
        return max(abs(v) for v in self.graph.probe.last(contracts.JOINT_STATES).velocity)

    def speeds(self) -> tuple[Array, Array]:
        """Times [s] and speeds of the fastest joint [rad/s], all that was heard."""
        mail = self.graph.probe.mail[contracts.JOINT_STATES.name]
        times = np.array([from_stamp(message.header.stamp) for message in mail])
        return times, np.abs([message.velocity for message in mail]).max(axis=-1)

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
