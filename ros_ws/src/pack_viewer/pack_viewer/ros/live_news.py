"""News from a running cell, read without an executor that wakes up for every message."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy

from pack_core.errors import ConfigError
from pack_core.ros.contracts.contract import NEWEST, Contract
from pack_core.ros.stream import Stream
from pack_viewer.news import News, Topics, seconds

JOINT_STATES = "/joint_states"
"""Tells simulated time: every cell has it, often, and stamped by the simulator."""
RESTART = 1.0
"""Simulated time that goes back by more means that the simulator was started anew [s]."""
QUEUE = 200
"""Messages of an event topic that may wait."""


class LiveNews:
    """Takes what has come since the last look; the middleware has dropped what is out of date by then.

    Args:
        node: who listens.
        contracts: the cell's wiring table.
        topics: what is listened to.

    Raises:
        ConfigError: the cell has no topic of a name.
    """

    def __init__(self, node: Node, contracts: Sequence[Contract], topics: Topics) -> None:
        known = {contract.name: contract for contract in contracts}
        if missing := [name for name in topics.all if name not in known]:
            raise ConfigError(f"the cell has no topic {', '.join(missing)}; it has {', '.join(known)}")
        self._streams = {name: _stream(node, known[name], name in topics.states) for name in topics.all}
        self._time: float | None = None

    def take(self) -> tuple[News]:
        """What has come since the last call."""
        messages = {name: stream.take_all() for name, stream in self._streams.items()}
        before = self._time
        if joints := messages[JOINT_STATES]:
            self._time = seconds(joints[-1])
        restarted = before is not None and self._time is not None and self._time < before - RESTART
        return (News({name: found for name, found in messages.items() if found}, self._time, restarted),)


def _stream(node: Node, contract: Contract, is_state: bool) -> Any:
    """A stream of the newest message alone, or of every message."""
    assert contract.qos is not None
    is_latched = contract.qos.durability is DurabilityPolicy.TRANSIENT_LOCAL
    if is_state and not is_latched:
        return Stream(node, replace(contract, qos=NEWEST))
    return Stream(node, contract, depth=1 if is_state else QUEUE)
