"""Serves a running cell to a PLC: an OPC UA server beside the cell's nodes."""

from __future__ import annotations

import time
from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from pack_interfaces.msg import NodeStatus
from pydantic import Field

from pack_bringup.graph.graph import load_graph
from pack_bringup.job import CellGoal
from pack_bringup.opcua.alarms import AlarmKind
from pack_bringup.opcua.production import Production
from pack_bringup.opcua.server import Answer, Method, OpcUaServer, ServerSettings, check_installed
from pack_bringup.opcua.view import PlcView, ValueType
from pack_bringup.ros.status_listener import STATE_WORDS
from pack_core.addresses import LOOPBACK
from pack_core.cells import CELLS, cell_part, check_cell, optional_cell_part
from pack_core.config import Config
from pack_core.errors import PackError
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import EVENTS, Contract, goal_states_of
from pack_core.ros.contracts.table import goal_actions, wiring_of
from pack_core.ros.node import CellNode
from pack_core.ros.node_status import LISTENING
from pack_core.ros.run import run_node
from pack_core.ros.running_cell import RunningCell
from pack_core.ros.stream import Stream

PERIOD = 0.1
"""Time between two looks at what has come [s of wall clock]."""
WHO = "a client of OPC UA"
ENDS = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED)


class OpcuaNodeConfig(Config):
    """Parameters of the node `opcua`."""

    cell: str = Field(default=CELLS[0], description="the cell that is served")
    host: str = Field(
        default=LOOPBACK,
        description="address to listen on; others than this machine's need certificate, key and trusted",
    )
    port: int = Field(default=4840, ge=1, le=65535, description="port to listen on")
    certificate: str = Field(default="", description="file with the server's certificate; empty: none")
    key: str = Field(default="", description="file with its private key; empty: none")
    trusted: str = Field(default="", description="folder with certificates of clients; empty: any client")

    def settings(self) -> ServerSettings:
        """Where the server listens, and who is let in."""
        certificate, key, trusted = (
            Path(text) if text else None for text in (self.certificate, self.key, self.trusted)
        )
        return ServerSettings(self.host, self.port, certificate, key, trusted)


class OpcuaNode(CellNode):
    """Node `opcua`: tells what a cell is at, and asks it for what a client wants.

    Attributes:
        view: what clients read.
        cell: what is asked of the cell.
    """

    may_be_repeated = True

    def __init__(self, **kwargs: Any) -> None:
        check_installed()
        super().__init__("opcua", **kwargs)
        config = self.read_parameters(OpcuaNodeConfig)
        self._cell = check_cell(config.cell)
        self._begun_ns = time.time_ns()
        nodes = [node.name for node in load_graph(self._cell).nodes]
        production: type[Production] = cell_part(self._cell, "production")
        self.view = PlcView(self._cell, nodes, production())
        actions = goal_actions(self._cell)
        self.cell = RunningCell(self, actions, self._note, "over OPC UA")
        self._next: CellGoal | None = None
        self._last: CellGoal | None = None
        self._ended_goals: set[bytes] = set()
        self._streams = self._listen(actions)
        self.create_subscription(NodeStatus, shared.NODE_STATUS.name, self._on_node, LISTENING)
        self.listen(shared.DIAGNOSTICS, self._on_health)
        self.watch(nodes, self._on_peer)
        self._server = OpcUaServer(
            config.settings(), f"PackCell, {self._cell}", self.view.variables(), self._methods(),
            partial(self._note, kind="error"),
        )  # fmt: skip
        self.create_timer(PERIOD, self._turn, clock=self.wall)
        print(f"OPC UA: {config.settings().address}, object Cell, of {self._cell}", flush=True)

    def destroy_node(self) -> None:
        """Stop serving, then end."""
        self._server.stop()
        super().destroy_node()

    # What is heard

    def _listen(self, actions: list[Contract]) -> list[tuple[Stream, Callable[[Any], None]]]:
        """Streams, and what takes their messages; what was sent before our start is left out."""
        known = {contract.name: contract for contract in wiring_of(self._cell)}
        heard = [
            (Stream(self, known[topic], depth=EVENTS.depth), partial(self.view.production.take, topic))
            for topic in self.view.production.topics
        ]
        # The last, because a goal's end is told after the reasons for it.
        return heard + [(Stream(self, goal_states_of(action, "user")), self._on_goals) for action in actions]

    def _turn(self) -> None:
        # The ends of goals are taken first and told last: by then all has come that says why they ended.
        news = [(stream, take, stream.take_with_times()) for stream, take in reversed(self._streams)]
        for stream, take, messages in reversed(news):
            for sent_ns, message in messages:
                if sent_ns >= self._begun_ns:
                    self.guard(stream.contract, take, message)
        view, now = self.view, datetime.now(UTC)
        view.condition = self.cell.condition
        stopped = (self.cell.arm.reason or "no reason was given") if view.condition.is_stopped else ""
        view.alarms.put(AlarmKind.ARM_STOPPED, stopped, now)
        view.alarms.put(AlarmKind.STEP_FAULT, view.production.fault, now)
        if view.condition.is_busy:
            view.alarms.put(AlarmKind.GOAL_FAILED, "", now)
        self._server.write(view.values())
        self._server.tell(view.alarms.take_changes())

    def _on_goals(self, message: GoalStatusArray) -> None:
        for status in message.status_list:
            goal = bytes(status.goal_info.goal_id.uuid)
            if status.status not in ENDS or goal in self._ended_goals:
                continue
            self._ended_goals.add(goal)
            success, now = status.status == GoalStatus.STATUS_SUCCEEDED, datetime.now(UTC)
            words = self.view.production.message or ("done" if success else "see the log of the cell's nodes")
            self.view.end_goal(success, words, now)
            self.view.production.message = ""
            if not success:
                self.view.alarms.put(AlarmKind.GOAL_FAILED, words, now)

    def _on_node(self, status: NodeStatus) -> None:
        self.view.node_states[status.name] = STATE_WORDS[status.state], status.waits_for

    def _on_health(self, message: DiagnosticArray) -> None:
        now = datetime.now(UTC)
        for status in message.status:
            if status.name != self.get_name():
                fault = status.message if status.level >= DiagnosticStatus.ERROR else ""
                self.view.alarms.put(AlarmKind.NODE_FAULT, fault, now, status.name)

    def _on_peer(self, peer: str, is_alive: bool) -> None:
        if is_alive:
            return
        self.view.node_states.pop(peer, None)
        text = "its process has ended, or it hangs"
        self.view.alarms.put(AlarmKind.NODE_FAULT, text, datetime.now(UTC), peer)

    def _note(self, text: str, kind: str) -> None:
        """A request to the cell has failed; that the arm was stopped is an alarm of its own."""
        if kind == "error":
            self.view.alarms.put(AlarmKind.REQUEST_FAILED, text, datetime.now(UTC))

    # What is asked for; called from the server's thread for requests

    def _methods(self) -> list[Method]:
        text = ("Order", ValueType.STRING, "an order (JSON), list or problem (YAML); empty: one by the seed")
        seed = ("Seed", ValueType.COUNT, "of what is random, such as where boxes arrive in the simulator")
        boxes = ("Boxes", ValueType.COUNT, "the shift ends when so many have come")
        reason = ("Reason", ValueType.STRING, "who stops the arm and why")
        methods = [
            Method("SetNextOrder", "choose what Start sends", (text, seed), self._set_next_order),
            Method("Start", "send the next order to the cell as it stands", (), self._start),
            Method("Cancel", "end the goal in progress in good order", (), self._cancel),
            Method("Stop", "brake the arm at once and hold it; the goal ends", (reason,), self._stop),
            Method("Resume", "let the arm follow setpoints again after Stop", (), self._resume),
            Method("Reset", "put a simulated cell into the next order's scene", (), self._reset),
        ]
        if optional_cell_part(self._cell, "shift_goal") is not None:
            methods += [
                Method("RunShift", "begin a shift", (boxes, seed), self._run_shift),
                Method("ResumeShift", "go on with the newest shift", (), self._resume_shift),
            ]
        return methods

    def _set_next_order(self, text: str, seed: int, told: Answer) -> None:
        self._next = cell_part(self._cell, "given_goal" if text else "seeded_goal")(
            *filter(None, [text]), seed
        )
        self.view.next_order = f"{len(text)} characters, seed {seed}" if text else f"seed {seed}"
        told("")

    def _start(self, told: Answer) -> None:
        if self._next is None:
            raise PackError("there is no next order; SetNextOrder chooses one")
        self._send(self._next, told)
        self._last, self._next, self.view.next_order = self._next, None, ""

    def _cancel(self, told: Answer) -> None:
        if not self.cell.condition.is_busy:
            raise PackError("no goal is in progress")
        self.cell.cancel(WHO, self._settling(told))

    def _stop(self, reason: str, told: Answer) -> None:
        self.cell.stop(f"{WHO}: {reason}" if reason else WHO, self._settling(told))

    def _resume(self, told: Answer) -> None:
        self.cell.resume(WHO, self._settling(told))

    def _reset(self, told: Answer) -> None:
        goal = self._next or self._last
        if goal is None:
            raise PackError("no order says what scene the cell is put into; SetNextOrder chooses one")
        self.cell.reset(goal.reset(), WHO, self._settling(told))
        self.view.alarms.put(AlarmKind.GOAL_FAILED, "", datetime.now(UTC))

    def _run_shift(self, boxes: int, seed: int, told: Answer) -> None:
        if boxes < 1:
            raise PackError(f"{boxes} boxes; allowed: 1 and more")
        self._send(cell_part(self._cell, "shift_goal")(boxes, seed, is_resumed=False), told)

    def _resume_shift(self, told: Answer) -> None:
        self._send(cell_part(self._cell, "shift_goal")(0, 0, is_resumed=True), told)

    def _send(self, goal: CellGoal, told: Answer) -> None:
        self.cell.send(goal.goal(), None, WHO, self._settling(told))

    def _settling(self, told: Answer) -> Answer:
        """Tells how a request went; one that was done ends the alarm about an earlier one that was not."""

        def tell(reason: str) -> None:
            if not reason:
                self.view.alarms.put(AlarmKind.REQUEST_FAILED, "", datetime.now(UTC))
            told(reason)

        return tell


def main() -> int:
    """Entry point of `opcua_node`."""
    return run_node(OpcuaNode)
