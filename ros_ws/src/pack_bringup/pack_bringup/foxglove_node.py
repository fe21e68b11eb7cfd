"""A cell's live topics over the protocol of Foxglove and Lichtblick: read only, for this machine only."""

from __future__ import annotations

import time
from typing import Any

from pydantic import Field
from rosbags.typesys.store import Typestore

from pack_bringup.recording.ros.recorded_topics import message_types
from pack_core.addresses import FOXGLOVE_PORT, LOOPBACK
from pack_core.cells import check_cell
from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract, Kind
from pack_core.ros.contracts.table import wiring_of
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_core.ros.stream import NodeThread, Stream

try:
    import foxglove
except ModuleNotFoundError:  # an extra, which `make setup` does not install
    foxglove = None

"""Browsers of any web page may connect, so nothing but this machine is listened to, and nothing is taken."""
PERIOD = 1.0 / 30.0
"""Time between two checks of the topics [s of wall clock]."""


class FoxgloveNodeConfig(Config):
    """Parameters of the node `foxglove`."""

    cell: str = Field(default="packing", description="whose topics are served")
    port: int = Field(default=FOXGLOVE_PORT, ge=1, le=65535, description=f"of the server, on {LOOPBACK}")


class ServedTopic:
    """A topic that is listened to only while a client wants it.

    Messages are passed on as they came, without being built: three shown topics cost what
    taking the bytes of three topics costs.

    Args:
        node: that listens.
        contract: the topic.
        types: definitions of all messages.
    """

    def __init__(self, node: CellNode, contract: Contract, types: Typestore) -> None:
        self._node, self._contract = node, contract
        name = f"{contract.type.__module__.split('.')[0]}/msg/{contract.type.__name__}"
        text, _ = types.generate_msgdef(name, ros_version=2)
        schema = foxglove.Schema(name=name, encoding="ros2msg", data=text.encode())
        self._channel = foxglove.Channel(contract.name, schema=schema, message_encoding="cdr")
        self._stream: Stream | None = None

    @property
    def is_heard(self) -> bool:
        """Whether a client wants the topic, so that it is listened to."""
        return self._stream is not None

    def pass_on(self, time_ns: int) -> None:
        """Pass on what has come, with the present simulated time [ns]."""
        if self._channel.has_sinks() is not self.is_heard:
            self._follow_clients()
        if self._stream is not None:
            for data in self._stream.take_all():
                self._channel.log(bytes(data), log_time=time_ns)

    def _follow_clients(self) -> None:
        if self._stream is None:
            # Latched messages come again to each new subscription.
            self._stream = Stream(self._node, self._contract, raw=True)
        else:
            self._stream.close()
            self._stream = None


class FoxgloveNode(CellNode):
    """Serves the topics of one cell."""

    may_be_repeated = True

    def __init__(self, **kwargs: Any) -> None:
        if foxglove is None:
            raise ConfigError("foxglove-sdk is not installed; docs/operate/rviz_and_foxglove.md says how")
        super().__init__("foxglove", **kwargs)
        config = self.read_parameters(FoxgloveNodeConfig)
        contracts = wiring_of(check_cell(config.cell))
        types = message_types()
        self.topics = [ServedTopic(self, c, types) for c in contracts if c.kind is Kind.TOPIC]
        self._server = _start_server(config)
        self._ticks = Stream(self, shared.CLOCK)
        self._now_ns = 0
        self._thread = NodeThread(self, self._turn, "foxglove")

    def destroy_node(self) -> None:
        """Stop serving, then end."""
        self._thread.end()
        self._server.stop()
        super().destroy_node()

    def _turn(self) -> None:
        for tick in self._ticks.take_all():
            self._now_ns = round(1e9 * from_stamp(tick.clock))
        self._server.broadcast_time(self._now_ns)
        for topic in self.topics:
            topic.pass_on(self._now_ns)
        time.sleep(PERIOD)


def _start_server(config: FoxgloveNodeConfig) -> Any:
    """The server, without the capabilities with which a client could publish, call or set anything."""
    try:
        return foxglove.start_server(
            name=f"PackCell, {config.cell}", host=LOOPBACK, port=config.port,
            capabilities=[foxglove.websocket.Capability.Time],
        )  # fmt: skip
    except (OSError, RuntimeError) as error:
        raise ConfigError(
            f"port {config.port} of {LOOPBACK}: {error}; choose another with the parameter `port`"
        ) from error


def main() -> int:
    """Entry point of `foxglove_node`."""
    return run_node(FoxgloveNode)
