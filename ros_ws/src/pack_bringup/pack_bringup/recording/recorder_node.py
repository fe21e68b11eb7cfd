"""The recorder: every topic that the wiring table marks as recorded, in one bag.

Bag stamps are simulated time, that of the last /clock received (0 before the first), so runs of
any real-time factor read alike; each message keeps its own header stamp besides.
"""

from __future__ import annotations

import time
from datetime import datetime
from operator import itemgetter
from pathlib import Path
from typing import Any

from rclpy.qos import QoSProfile
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

from pack_bringup.recording.message_types import message_types
from pack_bringup.recording.recorder import Recorder
from pack_bringup.recording.run_record import BAG_FOLDER, default_folder, describe_run
from pack_core import stamps
from pack_core.cells import optional_cell_part
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.contracts.table import nodes_of, recorded
from pack_core.ros.conversions import stamp_in
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_core.ros.stream import NodeThread, Stream
from pack_evaluation.raw_bag import Topic

DEPTH = 1000
"""Messages a topic that may wait in the middleware, whatever depth it has for others."""
DRAIN_PERIOD = 0.05
"""Wall clock between two looks at what has arrived [s]."""
FOREVER = QosTime(9223372036, 854775807)


class RecorderConfig(Config):
    """Parameters of the recorder."""

    path: str = ""
    """The run's folder; empty: bags/<cell>_<date>_seed<seed>."""
    cell: str = "packing"
    seed: int | None = None
    preset: str = ""
    """The conditions' name, for run.yaml."""
    command: str = ""
    """The command line that started the run, for run.yaml."""


class RecorderNode(CellNode):
    """Records the run and says what it was."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("recorder", **kwargs)
        config, now = read_parameters(self, RecorderConfig), datetime.now()
        self.folder = Path(config.path) if config.path else default_folder(config.cell, config.seed, now)
        topics = recorded(config.cell)
        self.recorder = Recorder(self.folder / BAG_FOLDER, map(_topic, topics), message_types())
        describe_run(config.cell, config.seed, config.command, now, config.preset).save(self.folder)
        self._time_ns = 0
        run_files = optional_cell_part(config.cell, "run_files")
        self._run_files = run_files(self.folder) if run_files else None
        self._streams = [Stream(self, contract, depth=DEPTH, raw=True) for contract in topics]
        self._drain = NodeThread(self, self._wait_and_drain, "drain")
        self.watch(nodes_of(config.cell) - {self.get_name()})
        self.get_logger().info(f"recording to {self.folder}")

    def report(self) -> None:
        """Report what was written, and a disk that fails."""
        self.health.values["written"] = str(self.recorder.written.total())
        self.health.values["dropped"] = str(self.recorder.dropped)
        if self.recorder.fault and "bag" not in self.health.faults:
            self.health.faults["bag"] = self.recorder.fault
            self.get_logger().error(self.recorder.fault)
        super().report()

    def destroy_node(self) -> None:
        """Finish the bag."""
        self._drain.end()
        self.drain()
        self.recorder.close()
        super().destroy_node()

    def drain(self) -> None:
        """Record all that has arrived, in the order in which it was sent."""
        taken = [
            (sent, stream.contract.name, data)
            for stream in self._streams
            for sent, data in stream.take_with_times()
        ]
        taken.sort(key=itemgetter(0))
        self.recorder.write_all([(topic, self._time_of(topic, data), data) for _, topic, data in taken])
        if self._run_files is not None:
            for _, topic, data in taken:
                self._note(topic, data)

    def _wait_and_drain(self) -> None:
        time.sleep(DRAIN_PERIOD)
        self.drain()

    def _time_of(self, topic: str, data: bytes) -> int:
        """Stamp in the bag [ns]: the time of the last tick of the clock, which may be this message."""
        if topic == shared.CLOCK.name:
            self.guard(shared.CLOCK, self._set_time, data)
        return self._time_ns

    def _set_time(self, clock: bytes) -> None:
        self._time_ns = stamps.to_ns(stamp_in(clock))

    def _note(self, topic: str, data: bytes) -> None:
        try:
            self._run_files.on_message(topic, data)
        except PackError as error:
            self.health.count(f"refused {topic}", str(error))


def _topic(contract: Contract) -> Topic:
    package = contract.type.__module__.split(".")[0]
    return Topic(contract.name, f"{package}/msg/{contract.type.__name__}", (_offered(contract.qos),))


def _offered(qos: QoSProfile) -> Qos:
    return Qos(
        history=QosHistory(qos.history), depth=qos.depth,
        reliability=QosReliability(qos.reliability), durability=QosDurability(qos.durability),
        deadline=FOREVER, lifespan=FOREVER,
        liveliness=QosLiveliness(qos.liveliness), liveliness_lease_duration=FOREVER,
        avoid_ros_namespace_conventions=False,
    )  # fmt: skip


def main() -> int:
    """Run the recorder node."""
    return run_node(RecorderNode)


if __name__ == "__main__":
    raise SystemExit(main())
