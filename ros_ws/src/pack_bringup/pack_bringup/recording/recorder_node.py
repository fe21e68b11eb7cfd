"""The recorder: every topic that the wiring table marks as recorded, in one bag.

Bag stamps are simulated time, that of the last /clock received (0 before the first), so runs of
any real-time factor read alike; each message keeps its own header stamp besides.
"""

from __future__ import annotations

from datetime import datetime
from operator import itemgetter
from pathlib import Path
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
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
from pack_core.ros.conversions import from_stamp
from pack_core.ros.params import read_parameters
from pack_core.ros.run import run_node
from pack_evaluation.raw_bag import Topic

DEPTH = 1000
"""Messages a topic that may wait in the middleware, whatever depth it has for others."""
DRAIN_PERIOD = 0.02
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


class TakenByHand(CallbackGroup):
    """Keeps its subscriptions out of the executor, which would take four times the processor time."""

    def can_execute(self, entity: Any) -> bool:
        """Never."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Never."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing began."""


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
        group = TakenByHand()
        self._taps = [(contract, self._tap(contract, group)) for contract in topics]
        self.create_timer(DRAIN_PERIOD, self.drain, clock=self.wall)
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
        self.drain()
        self.recorder.close()
        super().destroy_node()

    def drain(self) -> None:
        """Record all that has arrived, in the order in which it was sent."""
        taken: list[tuple[int, Contract, bytes]] = []
        for contract, tap in self._taps:
            with tap.handle:
                while (item := tap.handle.take_message(contract.type, True)) is not None:
                    taken.append((item[1]["source_timestamp"], contract, item[0]))
        for _, contract, data in sorted(taken, key=itemgetter(0)):
            self._record(contract, data)

    def _tap(self, contract: Contract, group: TakenByHand) -> Subscription:
        qos = QoSProfile(
            depth=DEPTH, reliability=contract.qos.reliability, durability=contract.qos.durability
        )
        return self.create_subscription(
            contract.type, contract.name, lambda _: None, qos, callback_group=group, raw=True
        )

    def _record(self, contract: Contract, data: bytes) -> None:
        if contract.name == shared.CLOCK.name:
            self._time_ns = stamps.to_ns(from_stamp(deserialize_message(data, contract.type).clock))
        self.recorder.write(contract.name, self._time_ns, data)
        if self._run_files is None:
            return
        try:
            self._run_files.on_message(contract.name, data)
        except PackError as error:
            self.health.count(f"refused {contract.name}", str(error))


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
