"""Injects faults into a running cell, one after the other, and reports what becomes of it."""

from __future__ import annotations

import math
import signal
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pack_bringup.graph.graph import Graph
from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.job import CellGoal
from pack_bringup.recording.run_record import BAG_FOLDER
from pack_bringup.robustness.arm_record import ArmRecord
from pack_bringup.robustness.fault_cases import FREEZE_TIME, GRASP, Fault, FaultCase, FaultReport
from pack_bringup.robustness.ros.cell_observer import CellObserver
from pack_core.errors import BagError, PackError
from pack_core.motion.topics import JOINT_STATES
from pack_core.ros.messages.conversions import from_stamp
from pack_evaluation.bag import read_bag

STAGE_TIMEOUT = 150.0
"""For a goal to come into a stage, and to end after a fault [s of wall clock]."""
MOVES = 0.05
"""Speed of the fastest joint from which the arm counts as moving [rad/s]."""
FAST = 0.3
"""A fault is injected when the fastest joint has this speed [rad/s]: then a stop can be told from a start."""
IN_STAGE = 0.4
"""Or after so long in a stage in which the arm stands or is slow [s simulated]."""
BRIEF = {"PERCEIVE": 0.1, GRASP: 0.1}
"""The same for stages that take 0.2 to 0.3 s and in which the arm always stands [s simulated]."""
FRESH = 0.05
"""Age of the newest joint state above which nothing is said of the arm's speed now [s of wall clock]."""
WATCHED = 3.0
"""For which the arm is watched after a fault [s simulated]: in every cell it has then stopped or goes on."""
STOPPED = 0.7
"""After a fault, when it is noted what is held [s simulated]: the arm stands; a goal may let go later."""
GOAL_TIMEOUT = 10.0
"""A goal that has not ended so long after a fault goes on [s of wall clock]."""
BEFORE = 0.5
"""Time before a fault of which speeds are kept [s simulated]."""


class FaultInjector:
    """One cell that runs, and is mended after every fault.

    Args:
        graph: the cell's nodes.
        group: their processes, started.
        observer: listens in the cell's domain.
        goal: what the cell is asked to do, again and again.
        folder: takes the recordings.
    """

    def __init__(
        self, graph: Graph, group: ProcessGroup, observer: CellObserver, goal: CellGoal, folder: Path
    ) -> None:
        self._graph, self._group, self._observer, self._goal = graph, group, observer, goal
        self._folder, self._recordings = folder, 0
        self._names = [node.name for node in graph.nodes]

    def try_case(self, case: FaultCase) -> FaultReport:
        """Inject one fault, mend the cell, and try the next goal."""
        found: dict[str, Any] = {}
        try:
            self._await_ready()
            self._observer.send(self._goal)
            self._await_stage(case.stage)
            self._inject(case, found)
        except PackError as error:
            found["problem"] = str(error)
        self._mend()
        return FaultReport(case.name, case.node, case.fault, case.stage, **found)

    def _await_ready(self) -> None:
        self._observer.await_ready(self._names)
        settled = time.monotonic() + 1.0  # all have then heard of each other
        self._observer.spin_until(lambda: time.monotonic() > settled, 2.0)

    def _await_stage(self, stage: str) -> None:
        observer, entered, excuse = self._observer, math.inf, ""

        def is_time() -> bool:
            nonlocal entered, excuse
            if observer.result is not None:
                raise PackError(f"the goal ended first: {observer.result.message}{excuse}")
            if observer.arm.age(time.time_ns()) > FRESH:
                if observer.stage == stage:
                    excuse = f"; in {stage} joint states came over {FRESH} s late: the machine is too busy"
                return False  # what the arm did meanwhile is still in the queue
            if observer.stage != stage:
                entered = math.inf
                return False
            entered = min(entered, observer.arm.time)
            is_fast = stage not in BRIEF and observer.arm.speed > FAST
            return is_fast or observer.arm.time > entered + BRIEF.get(stage, IN_STAGE)

        if not observer.spin_until(is_time, STAGE_TIMEOUT):
            raise PackError(f"the goal did not come into the stage {stage}{excuse}")

    def _inject(self, case: FaultCase, found: dict[str, Any]) -> None:
        observer = self._observer
        found |= {
            "was_held": observer.holds,
            "speed": observer.arm.speed,
            "real_time_factor": observer.factor,
        }
        recording, struck, struck_ns = self._bag, time.monotonic(), time.time_ns()
        is_freeze = case.fault is Fault.FREEZE
        self._group.signal(case.node, signal.SIGSTOP if is_freeze else signal.SIGKILL)
        if case.fault is Fault.RESTART:
            self._restart(case.node)
        is_lost = case.node == self._goal.server and not is_freeze
        if is_lost:
            observer.forget()
        found |= self._watch(struck, struck_ns, FREEZE_TIME if is_freeze else 0.0, is_lost=is_lost)
        if is_freeze:
            self._group.signal(case.node, signal.SIGCONT)
        if case.node != "sim":
            fault_time = observer.arm.simulated(struck_ns)
            found |= asdict(observer.arm.stop_after(fault_time)) | {
                "speed": observer.arm.speed_at(fault_time)
            }
            observer.arm.save(
                self._folder / "speeds" / f"{case.name}.csv", fault_time - BEFORE, fault_time + WATCHED
            )
        named = observer.silences_of(case.node, struck)
        found["named_by"] = tuple(sorted({by for _, by in named}))
        found["named_after"] = min((at for at, _ in named), default=math.nan)
        if case.node == "recorder" and not is_freeze:
            found["bag_lost"] = _lacking(recording, observer.arm, struck_ns)
        found["next_works"] = self._try_next(case)

    def _watch(self, struck: float, struck_ns: int, least: float, *, is_lost: bool) -> dict[str, Any]:
        """Wait until the arm was watched and the goal has ended, or plainly goes on; how the goal ended.

        Args:
            struck: when the fault was injected, on the steady clock [s].
            struck_ns: the same [ns since the epoch].
            least: time to wait [s of wall clock].
            is_lost: whether the node that would tell the result has ended.
        """
        observer, fault_time = self._observer, self._observer.arm.simulated(struck_ns)
        ended, is_held = math.nan, observer.holds

        def is_over() -> bool:
            nonlocal ended, is_held
            now = time.monotonic() - struck
            if observer.arm.time <= fault_time + STOPPED:
                is_held = observer.holds
            ended = now if observer.result is not None and math.isnan(ended) else ended
            is_watched = observer.arm.time > fault_time + WATCHED or now > 4.0 * WATCHED
            return now > least and is_watched and (is_lost or not math.isnan(ended) or now > GOAL_TIMEOUT)

        observer.spin_until(is_over, FREEZE_TIME + 30.0)
        goal = "lost with its node" if is_lost else ""
        if not math.isnan(ended):
            reason = getattr(observer.result, "exit_reason", "")
            goal = ": ".join(filter(None, (reason, observer.result.message))) or "success"
        return {"is_held": is_held, "goal": goal, "goal_after": ended}

    def _try_next(self, case: FaultCase) -> bool:
        """Whether the next goal is taken and moves the arm, once the victim runs again."""
        self._end_goal()
        if case.fault is Fault.KILL:
            self._restart(case.node)
        try:
            self._await_ready()
            self._observer.send(self._goal)
        except PackError:
            return False
        begun = self._observer.arm.time
        moved = self._observer.spin_until(
            lambda: self._observer.arm.time > begun + 0.1 and self._observer.arm.speed > MOVES, 60.0
        )
        return moved and self._observer.result is None

    def _end_goal(self) -> None:
        self._observer.cancel()
        self._observer.spin_until(lambda: self._observer.result is not None, 20.0)

    def _mend(self) -> None:
        """Bring the cell into a state from which the next case can begin."""
        for name in set(self._names) - set(self._group.running):
            self._restart(name)
        self._end_goal()

    def _restart(self, name: str) -> None:
        self._group.wait(10.0, count=1)
        self._observer.statuses.pop(name, None)
        overrides = None
        if name == "recorder":
            self._recordings += 1
            overrides = self.recorder_parameters(self._folder, self._recordings)
        (node,) = self._graph.only([name]).nodes
        self._group.restart(name, node.command(overrides))

    @staticmethod
    def recorder_parameters(folder: Path, number: int = 0) -> dict[str, str]:
        """Parameters of the recorder that writes the recording of this number, as YAML text."""
        return {"path": f'"{(folder / f"recording_{number}").resolve()}"', "record": "always"}

    @property
    def _bag(self) -> Path:
        return self._folder / f"recording_{self._recordings}" / BAG_FOLDER


def _lacking(bag: Path, arm: ArmRecord, struck_ns: int) -> float:
    """Simulated time before a moment of the wall clock that a recording lacks [s], if need be all of it."""
    try:
        messages = read_bag(bag.parent).of(JOINT_STATES)
        newest = max((from_stamp(message.header.stamp) for message in messages), default=0.0)
    except BagError:
        newest = 0.0
    return max(0.0, arm.simulated(struck_ns) - newest)
