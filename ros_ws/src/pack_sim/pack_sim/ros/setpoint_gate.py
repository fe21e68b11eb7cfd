"""Lets setpoints through to the driver only from one living sender, and only while the arm is not stopped."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock

from pack_core.errors import MessageError
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.node import CellNode
from pack_core.ros.sole_publisher import SolePublisher
from pack_core.ros.stream import Stream, StreamReader
from pack_sim.ros.arm_brake import ArmBrake

PARAMETER = "one_sender"
"""Of the simulator's node: whether setpoints are refused while more than one node sends them."""
READ_PERIOD = 0.05
"""Longest time for which the reader waits for setpoints [s of wall clock]."""


class SetpointGate:
    """Reads setpoints in a thread of its own: at the executor each would wait for what else the node does.

    Args:
        node: the driver's node; it has the parameter `one_sender`.
        contract: of the setpoints.
        sender: the node that sends them; when it falls silent the arm is held.
        brake: knows whether the arm was stopped.
        accept: hands serialised setpoints to the driver, if they may be followed, which it asks under the
            lock; raises MessageError when they are refused.
        drop: lets the driver forget its setpoints, under the lock.
        lock: held while `drop` is called.
    """

    def __init__(
        self, node: CellNode, contract: Contract, sender: str, brake: ArmBrake,
        accept: Callable[[bytes, Callable[[], bool]], None], drop: Callable[[], None], lock: Lock,
    ) -> None:  # fmt: skip
        self._node, self._sender, self._brake = node, sender, brake
        self._accept, self._drop, self._lock = accept, drop, lock
        self._is_abandoned = False
        self._stream = Stream(node, contract, raw=True, on_match=lambda: self._publishers.check())
        self._publishers = SolePublisher(node, self._stream.topic_name, self._on_publishers)
        self._publishers.track(sender)
        node.watch((sender,), self._on_sender)
        self._reader = StreamReader(node, (self._stream,), self._read, READ_PERIOD)

    def end(self) -> None:
        """Read no more setpoints."""
        self._reader.end()

    def note_end(self, peer: str) -> None:
        """The process of a watched node has ended; any thread may say so."""
        self._publishers.forget(peer)

    def _read(self) -> None:
        for data in self._stream.take_all():
            self._node.guard(self._stream.contract, self._on_setpoints, data)

    def _on_setpoints(self, data: bytes) -> None:
        self._accept(data, self._may_follow)

    def _may_follow(self) -> bool:
        """Whether the arm may follow setpoints now; raises MessageError where their sender is to be told."""
        if self._is_abandoned:
            raise MessageError("their sender has fallen silent since; the arm holds")
        if self._publishers.trouble and self._refuses_two:
            raise MessageError(f"{self._publishers.trouble}; allowed: one sender (parameter {PARAMETER})")
        return self._brake.check()

    def _on_sender(self, _: str, is_alive: bool) -> None:
        self._is_abandoned = not is_alive
        if self._is_abandoned:
            self._hold()

    def _on_publishers(self, trouble: str) -> None:
        """Name those that send setpoints when they are more than one, and have the arm brake."""
        if not trouble:
            self._node.health.faults.pop(PARAMETER, None)
            return
        self._node.health.faults[PARAMETER] = f"{trouble}; end all but one"
        self._node.get_logger().error(self._node.health.faults[PARAMETER])
        if self._refuses_two:
            self._hold()

    def _hold(self) -> None:
        with self._lock:
            self._drop()

    @property
    def _refuses_two(self) -> bool:
        return bool(self._node.get_parameter(PARAMETER).value)
