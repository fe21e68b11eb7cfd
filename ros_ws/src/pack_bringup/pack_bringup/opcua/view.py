"""The values of a cell that an OPC UA client reads, from what the cell says of itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any

from pack_bringup.opcua.alarms import AlarmBoard
from pack_bringup.opcua.production import Production
from pack_core.cell_condition import CellCondition


class ValueType(StrEnum):
    """A value's type: its name among OPC UA's."""

    BOOLEAN = "Boolean"
    STRING = "String"
    COUNT = "UInt32"
    TIME = "DateTime"


@dataclass(frozen=True)
class Variable:
    """A value that can be read.

    Attributes:
        path: names from the cell's object on, with dots between them.
        type: of the value, or of each of its elements.
        what: it says, for whoever browses.
        is_list: whether it holds any number of values.
    """

    path: str
    type: ValueType
    what: str
    is_list: bool = False


class CellState(StrEnum):
    """What the cell is at, in a word."""

    NOT_UP = "NotUp"
    WAITING = "Waiting"
    READY = "Ready"
    STARTING = "Starting"
    BUSY = "Busy"
    PAUSED = "Paused"
    STOPPED = "Stopped"


def state_of(condition: CellCondition) -> CellState:
    """What a cell in this condition is at."""
    if not condition.is_up:
        return CellState.NOT_UP
    if condition.is_stopped:
        return CellState.STOPPED
    if condition.is_paused:
        return CellState.PAUSED
    if condition.is_busy:
        return CellState.BUSY
    if condition.is_starting:
        return CellState.STARTING
    return CellState.WAITING if condition.waits_for else CellState.READY


NEVER = datetime(1601, 1, 1, tzinfo=UTC)
"""OPC UA's zero, which clients show as no time."""


class PlcView:
    """What is known of a cell.

    Args:
        cell: its name.
        nodes: names of its nodes.
        production: follows its work.

    Attributes:
        condition: what the cell is at.
        node_states: of each node its state in words, and what it waits for.
        next_order: what the next start will send, in words; empty where nothing waits.
        goals_done: how many goals ended with success.
        goals_failed: how many ended without.
        last_success: whether the last goal ended with success.
        last_message: why it ended as it did.
        last_end: when it did.
    """

    def __init__(self, cell: str, nodes: Sequence[str], production: Production) -> None:
        self._cell, self._nodes = cell, tuple(nodes)
        self.production, self.alarms = production, AlarmBoard()
        self.condition = CellCondition()
        self.node_states: dict[str, tuple[str, str]] = {}
        self.next_order = ""
        self.goals_done = self.goals_failed = 0
        self.last_success, self.last_message, self.last_end = False, "", NEVER

    def end_goal(self, success: bool, message: str, now: datetime) -> None:
        """A goal has ended."""
        self.goals_done += success
        self.goals_failed += not success
        self.last_success, self.last_message, self.last_end = success, message, now

    def variables(self) -> Iterator[Variable]:
        """All values, in the order in which a browser shows them."""
        work = self.production
        yield Variable("Name", ValueType.STRING, "name of the cell")
        yield Variable("State", ValueType.STRING, f"one of {', '.join(CellState)}")
        yield Variable("StateText", ValueType.STRING, "the same in words, with what is waited for")
        yield Variable("Step", ValueType.STRING, "what the cell does now, in its own words")
        yield Variable("Item", ValueType.STRING, "what is in work")
        yield Variable("NextOrder", ValueType.STRING, "what Start will send; empty: nothing")
        yield Variable("Arm.IsStopped", ValueType.BOOLEAN, "the arm was stopped and follows no setpoints")
        for name, what in (
            ("GoalsDone", "goals that ended with success"), ("GoalsFailed", "goals that did not"),
            (work.items, f"{work.items.lower()} placed"),
            (work.carriers, f"{work.carriers.lower()} completed"), ("Faults", "alarms that have begun"),
        ):  # fmt: skip
            if name:
                yield Variable(f"Counters.{name}", ValueType.COUNT, f"{what}, since this server's start")
        yield Variable("LastGoal.Success", ValueType.BOOLEAN, "whether the last goal ended with success")
        yield Variable("LastGoal.Message", ValueType.STRING, "why it ended as it did")
        yield Variable("LastGoal.EndTime", ValueType.TIME, "when it ended")
        yield Variable("Alarms.Active", ValueType.STRING, "what is wrong now, oldest first", is_list=True)
        yield Variable("Alarms.Since", ValueType.TIME, "when each of these began", is_list=True)
        for node in self._nodes:
            yield Variable(f"Nodes.{node}.State", ValueType.STRING, "what it does")
            yield Variable(f"Nodes.{node}.WaitsFor", ValueType.STRING, "what it needs of others")

    def values(self) -> dict[str, Any]:
        """The value of each of `variables`."""
        work, alarms = self.production, self.alarms.active
        counts = {
            "GoalsDone": self.goals_done, "GoalsFailed": self.goals_failed, work.items: work.placed,
            work.carriers: work.pallets, "Faults": self.alarms.begun,
        }  # fmt: skip
        values: dict[str, Any] = {
            "Name": self._cell, "State": state_of(self.condition).value,
            "StateText": self.condition.in_words, "Step": work.step, "Item": work.item,
            "NextOrder": self.next_order, "Arm.IsStopped": self.condition.is_stopped,
            "LastGoal.Success": self.last_success, "LastGoal.Message": self.last_message,
            "LastGoal.EndTime": self.last_end, "Alarms.Active": [alarm.in_words for alarm in alarms],
            "Alarms.Since": [alarm.since for alarm in alarms],
        }  # fmt: skip
        values |= {f"Counters.{name}": count for name, count in counts.items() if name}
        for node in self._nodes:
            state, waits_for = self.node_states.get(node, ("not up", ""))
            values |= {f"Nodes.{node}.State": state, f"Nodes.{node}.WaitsFor": waits_for}
        return values
