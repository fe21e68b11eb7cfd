"""Serves the page of a running cell."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from pydantic import Field
from rclpy.node import Node

from pack_core.addresses import LOOPBACK, PAGE_PORT, PAGE_TOKEN_VARIABLE, page_address
from pack_core.cells import CELLS, cell_part
from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.motion.topics import JOINT_STATES
from pack_core.ros.contracts.contract import NEWEST, Contract
from pack_core.ros.contracts.table import goal_actions, nodes_of, wiring_of
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_core.ros.running_cell import RunningCell
from pack_core.ros.stream import NodeThread, Stream
from pack_viewer.cell_page import CellPage
from pack_viewer.event_log import EventLog
from pack_viewer.live_page import SHARED_TOPICS, LivePage
from pack_viewer.news import News, Topics, seconds
from pack_viewer.ros.parameter_sliders import ParameterSliders
from pack_viewer.ros.run_form import RunForm
from pack_viewer.run_panel import RunPanel
from pack_viewer.web_server import open_server

RESTART = 1.0
"""Simulated time that goes back by more means that the simulator was started anew [s]."""
SPARING = 6
"""Of so many frames one is drawn while the machine is busy."""
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
        if joints := messages[JOINT_STATES]:  # every cell has them, often, and stamped by the simulator
            self._time = seconds(joints[-1])
        restarted = before is not None and self._time is not None and self._time < before - RESTART
        return (News({name: found for name, found in messages.items() if found}, self._time, restarted),)


def _stream(node: Node, contract: Contract, is_state: bool) -> Any:
    """A stream of the newest message alone, or of every message."""
    if is_state and not contract.is_latched:
        return Stream(node, replace(contract, qos=NEWEST))
    return Stream(node, contract, depth=1 if is_state else QUEUE)


class LiveOperator(RunningCell):
    """Starts what the page's form holds.

    Args:
        node: who asks; it must be spun meanwhile.
        actions: the cell's actions, all of one node.
        form: what the next goal is.
        log: is told how requests went.
    """

    def __init__(self, node: CellNode, actions: Sequence[Contract], form: RunForm, log: EventLog) -> None:
        super().__init__(node, actions, log.add, "on the page")
        self._form = form

    def start(self, who: str) -> None:
        """Reset the cell and send the goal; raises PackError where the form holds none."""
        self.send(self._form.goal(), self._form.reset(), who)


class LiveNodeConfig(Config):
    """Parameters of the node `live`."""

    cell: str = Field(default=CELLS[0], description="the cell that is shown")
    port: int = Field(default=PAGE_PORT, ge=1, le=65535, description="port of the page")
    host: str = Field(
        default=LOOPBACK,
        description=f"address to listen on; others than {LOOPBACK} need a token, which is "
        f"read from the environment variable {PAGE_TOKEN_VARIABLE}",
    )
    frame_rate: float = Field(default=24.0, gt=0.0, le=60.0, description="frames a second of wall clock")


class LiveNode(CellNode):
    """Node `live`: a page in the browser that shows a cell and lets it be operated.

    Attributes:
        page: what is shown.
        form: what can be chosen for the next goal.
        operator: asks the cell for what is pressed.
        sliders: parameters that can be changed; None in a cell without.
    """

    may_be_repeated = True
    sliders: ParameterSliders | None = None

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("live", **kwargs)
        config = self.read_parameters(LiveNodeConfig)
        token = os.environ.get(PAGE_TOKEN_VARIABLE, "")
        page: type[CellPage] = cell_part(config.cell, "page")
        self._server = open_server(config.port, f"PackCell · {config.cell}", host=config.host, token=token)
        news = LiveNews(self, wiring_of(config.cell), page.topics + SHARED_TOPICS)
        self._cell = config.cell
        self.page = LivePage(
            self._server,
            page,
            news,
            self._add_controls,
            origin=f"{config.cell}, live",
            watched=nodes_of(config.cell),
        )
        self._period = 1.0 / config.frame_rate
        self._thread = NodeThread(self, self._turn, "page")
        # Without the token: what a node prints ends in files.
        needs = f", with the token of {PAGE_TOKEN_VARIABLE}" if token else ""
        print(f"page: {page_address(config.host, config.port)}{needs}", flush=True)

    def destroy_node(self) -> None:
        """Close the page, then end."""
        self._thread.end()
        self._server.stop()
        super().destroy_node()

    def _add_controls(self, log: EventLog) -> Callable[[], None]:
        self.form: RunForm = cell_part(self._cell, "run_form")(self._server.gui, log)
        actions = goal_actions(self._cell)
        self.operator = LiveOperator(self, actions, self.form, log)
        panel = RunPanel(self._server.gui, log, self.operator, self.form.add)
        if self.form.tuned is not None:  # below the buttons, so that STOP stays where it is
            self.sliders = ParameterSliders(self, self._server.gui, log, self.form.tuned)
        return panel.show

    def _turn(self) -> None:
        begun = time.monotonic()
        self.page.turn()
        period = self._period * (SPARING if self.page.cell.is_sparing else 1)
        time.sleep(max(0.0, begun + period - time.monotonic()))


def main() -> int:
    """Entry point of `live_node`."""
    return run_node(LiveNode)
