"""Which faults are tried in a cell, and what is written down about each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pack_bringup.graph.graph import load_graph
from pack_lockstep.disturbances import chosen


class Fault(StrEnum):
    """What is done to a node's process."""

    KILL = "kill"
    """It is killed, and started again once the goal has ended."""
    FREEZE = "freeze"
    """It is stopped for `FREEZE_TIME` (SIGSTOP), and goes on."""
    RESTART = "restart"
    """It is killed and started again at once."""


FREEZE_TIME = 5.0
"""How long a frozen process stands [s of wall clock]."""
GRASP = "GRASP"
"""In the cell blocks the part of PICK in which the fingers close."""
STAGES = {
    "packing": ("PRE_PACK", "INSERT", "FINE_TUNE"),
    # 5, 6, 10, 14 and 15 are left as soon as they are entered: they are one move with the state after them
    "palletizing": (
        "1 detect", "2 above box", "3 grasp", "4 lift", "7 rotate", "8 release table", "9 step back",
        "11 above table", "12 regrasp", "13 lift table", "16 above pallet", "17 pre deposit", "18 deposit",
        "19 retreat", "20 return",
    ),
    "blocks": ("PERCEIVE", "PICK", GRASP, "PLACE", "PUSH", "RETREAT"),  # PLAN takes 4 to 16 ms: never met
}  # fmt: skip
"""Stages of a goal in which faults are injected, by cell, as the goal's feedback names them (but `GRASP`)."""


@dataclass(frozen=True)
class FaultCase:
    """A fault of one node in one stage of a goal."""

    node: str
    fault: Fault
    stage: str

    @property
    def name(self) -> str:
        """As trials are named in the file of results."""
        return f"{self.fault} {self.node} in {self.stage}"


@dataclass(frozen=True)
class FaultReport:
    """What became of a cell after a fault.

    Times of the arm are in simulated time from the fault on; `nan` where nothing was to be measured.

    Attributes:
        name: of the case.
        node: the process that was hit.
        fault: what was done to it.
        stage: of the goal in that moment.
        real_time_factor: simulated seconds a second of wall clock, shortly before.
        speed: of the fastest joint in that moment [rad/s].
        brakes_after: when the arm began to brake until it stood [s].
        stands_after: when the arm stood [s].
        was_held: whether the gripper held something in that moment.
        is_held: whether it still did once the arm stood.
        named_by: nodes that said on /diagnostics that the node is silent.
        named_after: when the first of them said it [s of wall clock].
        goal: how the goal ended, in words; empty if it did not within the time that was waited.
        goal_after: when it ended [s of wall clock].
        next_works: whether the next goal was taken and moved the arm, with no other node restarted.
        bag_lost: simulated time before the fault that the recording lacks [s].
        problem: why the case could not be tried, or what went wrong besides; empty if nothing.
    """

    name: str
    node: str
    fault: str
    stage: str
    real_time_factor: float = float("nan")
    speed: float = float("nan")
    brakes_after: float = float("nan")
    stands_after: float = float("nan")
    was_held: bool = False
    is_held: bool = False
    named_by: tuple[str, ...] = ()
    named_after: float = float("nan")
    goal: str = ""
    goal_after: float = float("nan")
    next_works: bool = False
    bag_lost: float = float("nan")
    problem: str = ""


def fault_cases(
    cell: str, nodes: Sequence[str] = (), faults: Sequence[Fault] = (), stages: Sequence[str] = ()
) -> list[FaultCase]:
    """Every fault of every node in every stage, or those that are named.

    Raises:
        ConfigError: the cell has no such node or stage.
    """
    known = [node.name for node in load_graph(cell).nodes]
    cases = [FaultCase(node, fault, stage) for stage in STAGES[cell] for fault in Fault for node in known]
    return chosen(cases, node=("node", nodes), fault=("fault", faults), stage=("stage", stages))


def fault_row(report: Mapping[str, Any]) -> tuple[str, ...]:
    """A report as a row of the table, without what is the same for all rows."""

    def seconds(key: str) -> str:
        value = report[key]  # text where it is not finite, as JSON has no other
        return {"nan": "", "inf": "goes on"}[value] if isinstance(value, str) else f"{value:.2f}"

    held = {(True, True): "kept", (True, False): "LOST", (False, True): "gripped", (False, False): "-"}
    return (
        report["stage"], report["fault"], report["node"], seconds("speed"), seconds("brakes_after"),
        seconds("stands_after"), held[report["was_held"], report["is_held"]], ", ".join(report["named_by"]),
        seconds("named_after"), report["goal"] or "goes on", seconds("goal_after"),
        "yes" if report["next_works"] else "NO", seconds("bag_lost"), report["problem"],
    )  # fmt: skip


FAULT_COLUMNS = (
    "stage", "fault", "node", "speed [rad/s]", "brakes after [s sim.]", "stands after [s sim.]",
    "held object", "named by", "after [s]", "goal", "after [s]", "next goal works", "bag lacks [s sim.]", "",
)  # fmt: skip
