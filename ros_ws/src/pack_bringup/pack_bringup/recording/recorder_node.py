"""The recorder: every topic that the wiring table marks as recorded, in one bag, while goals run or always.

Bag stamps are simulated time, so runs of any real-time factor read alike: that of the last /clock received (0
before the first), and between two ticks of it that of the last joint states, which come five times as often.
Each message keeps its own header stamp besides.
"""

from __future__ import annotations

import time
from datetime import datetime
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

from pydantic import Field

from pack_bringup.recording.goal_gate import GoalGate, Sent
from pack_bringup.recording.recorder import Recorder
from pack_bringup.recording.ros.recorded_topics import (
    GoalsInProgress,
    message_types,
    status_contracts,
    to_bag_topic,
)
from pack_bringup.recording.run_record import BAG_FOLDER, Record, default_folder, describe_run
from pack_core import stamps
from pack_core.cells import optional_cell_part
from pack_core.config import Config
from pack_core.errors import BagError, MessageError, PackError
from pack_core.namespace import ROOT
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.contracts.motion import JOINT_STATES
from pack_core.ros.contracts.table import nodes_of, recorded
from pack_core.ros.messages.conversions import stamp_in
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_core.ros.stream import NodeThread, Stream
from pack_core.topics import CLOCK_RATE


class RecorderConfig(Config):
    """Parameters of the recorder."""

    path: str = Field(
        default="", description="the run's folder; empty: bags/<cell>_<date>_<preset>_seed<seed>"
    )
    cell: str = Field(default="packing", description="the cell whose topics are recorded")
    record: Record = Field(default="goals", description="when to record: while goals run, always, or never")
    split_mb: float = Field(default=24.0, gt=0.0, description="size at which another file is begun [MB]")
    limit_gb: float = Field(default=10.0, gt=0.0, description="size of the bag at which recording ends [GB]")
    pictures: bool = Field(
        default=False, description="also record what the cameras see, for `pack replay --node vision` or tags"
    )
    required: bool = Field(
        default=False, description="end the node, and so the goal in progress, when recording fails"
    )
    seed: int | None = Field(default=None, description="the run's seed, for run.yaml")
    preset: str = Field(default="", description="the conditions' name, for run.yaml and the folder")
    command: str = Field(default="", description="the command line that started the run, for run.yaml")

    @property
    def topics(self) -> tuple[Contract, ...]:
        """What is recorded."""
        return recorded(self.cell, with_pictures=self.pictures)


def begin_recording(config: RecorderConfig, namespace: str = ROOT) -> tuple[Path, Recorder]:
    """The run's folder with its description, and the bag in it, open.

    Args:
        config: what is recorded, and where.
        namespace: of the cell, which a folder that is not given is named after, too.

    Raises:
        BagError: it cannot be made or written.
    """
    now, name = datetime.now(), config.cell + "_".join(namespace.rstrip("/").split("/"))
    folder = Path(config.path) if config.path else default_folder(name, config.seed, now, config.preset)
    recorder = Recorder(
        folder / BAG_FOLDER, map(to_bag_topic, config.topics), message_types(),
        split_size=config.split_mb * 1e6, limit=config.limit_gb * 1e9,
    )  # fmt: skip
    try:
        describe_run(config.cell, config.seed, config.command, now, config.preset).save(folder)
    except OSError as error:
        recorder.close()
        raise BagError(f"cannot record to {folder}: {error}; give another `path`") from error
    return folder, recorder


def recording_plan(config: RecorderConfig) -> str:
    """What is recorded, and how far, in the words of the log."""
    what = "all that is sent" if config.record == "always" else "goals, from 2 s before to 2 s after each,"
    return (
        f"{what} in compressed files of {config.split_mb:g} MB, at most {config.limit_gb:g} GB together "
        "(limit_gb; then recording stops and the cell goes on)"
    )


DEPTH = 1000
"""Messages a topic that may wait in the middleware, whatever depth it has for others."""
CLOCK_PERIOD = stamps.to_ns(1.0 / CLOCK_RATE)
"""Of /clock [ns]. Joint states that are ahead of it by more were stamped by another clock."""
DRAIN_PERIOD = 0.05
"""Wall clock between two checks of what has arrived [s]."""


class RecorderNode(CellNode):
    """Records the run and says what it was.

    Attributes:
        folder: of the run.
        recorder: the open bag; None if nothing is to be recorded.
        received: number of messages that came, recorded or not.
    """

    recorder: Recorder | None = None
    received = 0

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("recorder", **kwargs)
        config = self.read_parameters(RecorderConfig)
        self._is_required = config.required
        if config.record == "never":
            self.get_logger().info("recording nothing (record: never)")
            return
        try:
            self.folder, self.recorder = begin_recording(config, self.get_namespace())
        except BagError as error:
            if config.required:
                raise
            self._say_fault(f"{error}; goals go on unrecorded")
            return
        topics = config.topics
        self._time_ns = 0
        run_files = optional_cell_part(config.cell, "run_files")
        self._run_files = run_files(self.folder) if run_files else None
        by_goals = config.record == "goals"
        status = status_contracts(config.cell) if by_goals else ()
        self._statuses = {contract.name: contract for contract in status}
        self._goals = GoalsInProgress(status)
        self._gate = GoalGate([topic.name for topic in topics if topic.is_latched]) if by_goals else None
        self._streams = [Stream(self, contract, depth=DEPTH, raw=True) for contract in (*topics, *status)]
        self._drain = NodeThread(self, self._wait_and_drain, "drain")
        self.watch(nodes_of(config.cell) - {self.get_name()}, self._on_peer)
        self.get_logger().info(f"recording {recording_plan(config)} to {self.folder}")

    @property
    def is_recording(self) -> bool:
        """Whether what comes now is recorded, apart from the time after a goal."""
        return self.recorder is not None and (self._gate is None or self._gate.is_goal)

    def report(self) -> None:
        """Report what was written, and a disk that fails."""
        if self.recorder is not None:
            self.health.values["written"] = str(self.recorder.written.total())
            self.health.values["dropped"] = str(self.recorder.dropped)
            if self._has_failed:
                self._say_fault(self.recorder.fault)
        super().report()
        if self._is_required and "bag" in self.health.faults:
            self.get_logger().error("the recorder ends, as parameter `required` says")
            self.context.try_shutdown()

    def destroy_node(self) -> None:
        """Finish the bag."""
        if self.recorder is not None:
            self._drain.end()
            self.drain()
            self.recorder.close()
        super().destroy_node()

    def drain(self) -> None:
        """Record what has arrived and is wanted, in the order in which it was sent."""
        assert self.recorder is not None, "nothing is recorded"
        taken = [
            (sent, stream.contract.name, data)
            for stream in self._streams
            for sent, data in stream.take_with_times()
        ]
        taken.sort(key=itemgetter(0))
        self.received += len(taken)
        wanted = [item for sent, topic, data in taken for item in self._choose(sent, topic, data)]
        # Once more without a message: the node that pursued the goal may have ended.
        wanted += self._open_or_close(time.time_ns())
        self.recorder.write_all([(item.topic, item.time_ns, item.data) for item in wanted])
        if self._run_files is not None:
            for _, topic, data in taken:
                self._note(topic, data)

    def _wait_and_drain(self) -> None:
        time.sleep(DRAIN_PERIOD)
        self.drain()
        if self._has_failed:
            self.report()  # at once, not with the next second

    @property
    def _has_failed(self) -> bool:
        """Whether the recorder has a fault that was not reported yet."""
        return self.recorder is not None and bool(self.recorder.fault) and "bag" not in self.health.faults

    def _say_fault(self, fault: str) -> None:
        self.health.faults["bag"] = fault
        self.get_logger().error(fault)

    def _choose(self, sent_ns: int, topic: str, data: bytes) -> list[Sent]:
        """What is to be recorded now that this message has come."""
        if topic in self._statuses:
            self.guard(self._statuses[topic], partial(self._goals.on_status, topic, sent_ns), data)
            return self._open_or_close(sent_ns)
        item = Sent(sent_ns, topic, self._time_of(topic, data), data)
        return [item] if self._gate is None else self._gate.take(item)

    def _open_or_close(self, now_ns: int) -> list[Sent]:
        gate = self._gate
        if gate is None or gate.is_goal is bool(self._goals):
            return []
        wanted = gate.set_goal(bool(self._goals), now_ns)
        what = "recording: a goal has begun" if gate.is_goal else "a goal has ended: recording 2 s more"
        self.get_logger().info(what)
        return wanted

    def _on_peer(self, peer: str, is_alive: bool) -> None:
        if not is_alive:
            self._goals.on_lost_node(peer, time.time_ns())

    def _time_of(self, topic: str, data: bytes) -> int:
        """Stamp in the bag [ns]: the newest time of clock and joint states, which may be this message's."""
        if topic == shared.CLOCK.name:
            self.guard(shared.CLOCK, self._set_time, data)
        elif topic == JOINT_STATES.name:
            self.guard(JOINT_STATES, self._move_on, data)
        return self._time_ns

    def _move_on(self, joint_states: bytes) -> None:
        if 0 < (ahead := _stamp_ns(joint_states) - self._time_ns) < CLOCK_PERIOD:
            self._time_ns += ahead

    def _set_time(self, clock: bytes) -> None:
        if (time_ns := _stamp_ns(clock)) < 0:
            raise MessageError(f"time {stamps.to_seconds(time_ns):.3f} s; a bag has none before 0")
        self._time_ns = time_ns

    def _note(self, topic: str, data: bytes) -> None:
        try:
            self._run_files.on_message(topic, data)
        except PackError as error:
            self.health.count(f"refused {topic}", str(error))


def _stamp_ns(data: bytes) -> int:
    return stamps.to_ns(stamp_in(data))


def main() -> int:
    """Run the recorder node."""
    return run_node(RecorderNode)


if __name__ == "__main__":
    raise SystemExit(main())
