"""A goal of `/run_shift`: what stands is looked at, the shift is run, and its journal is kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pack_interfaces.action import RunShift
from pack_interfaces.msg import PalletState

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.ports import Command, PalletObservation, PursueTarget, ScanPlace, StopArm
from pack_core.palletizing.shift_journal import (
    JOURNAL,
    SETTLED,
    EventKind,
    ShiftEvent,
    ShiftJournal,
    WrittenShift,
    read_interrupted,
)
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.conversions import to_stamp
from pallet_fsm.order_book import WorkItem, standing_box
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.place_watch import ArmShadow
from pallet_fsm.ros.order_goal import StatePublisher
from pallet_fsm.shift_job import ShiftJob
from pallet_fsm.step_aside import StepAside
from pallet_fsm.taking_over import TakenOver, rejected_by_journal, take_over
from pallet_fsm.transitions import Event


def requested_shift(goal: RunShift.Goal, preset: str) -> WrittenShift:
    """What the journal of a goal's folder has, or has to begin with.

    Raises:
        ConfigError: the folder cannot take a new shift, or has none to go on with.
    """
    if not goal.folder:
        raise ConfigError("the goal has no `folder`; allowed: one for the journal")
    folder = Path(goal.folder)
    path = folder / JOURNAL
    if goal.resume:
        return read_interrupted(path, preset)
    if path.exists():
        raise ConfigError(f"{path} is there already; allowed: another folder, or `resume`")
    if goal.boxes < 1:
        raise ConfigError(f"boxes is {goal.boxes}; allowed: 1 or more")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"{folder} cannot be made: {error.strerror}") from error
    return WrittenShift({"seed": goal.seed, "boxes": goal.boxes, "preset": preset}, ())


class TakeOverLook:
    """Has the places scanned on which something must stand, and compares; an arm in the way moves first.

    Args:
        cell: the cell's physical facts.
        standing: what must stand, by the journal; where nothing must, no place is scanned.
        config: parameters of the machine.
        clearances: from which distance on the arm is out of the way, by place [m].
    """

    def __init__(
        self, cell: PalletizingCell, standing: list[tuple[WorkItem, Item]], config: PalletizerConfig,
        clearances: Mapping[str, float],
    ) -> None:  # fmt: skip
        self._cell, self._standing, self._scans = cell, standing, config.scans
        self._places = (*cell.pallets, REORIENTATION_TABLE)
        blocks = {block.name: block for block in cell.furniture}
        self._shadows = {place: ArmShadow(blocks[place], cell) for place in clearances}
        self._clearances = clearances
        boxes = (standing_box(work.box, work.X_WB) for work, _ in standing if work.X_WB is not None)
        self._aside = StepAside(cell, config, tuple(boxes))
        self._asked: float | None = None

    def step(self, seen: PalletObservation) -> tuple[Command, ...] | TakenOver:
        """The commands of this step, and at last what stands.

        Raises:
            ConfigError: the arm is in the way and finds none from there, a scanner does not answer, or
                table B is not as it was left.
        """
        if self._asked is None:
            hidden = [
                place
                for place, shadow in self._shadows.items()
                if shadow.clearance(seen.motion.X_WT, None) <= self._clearances[place]
            ]
            if hidden or self._aside.is_moving:
                return self._move_away(hidden, seen)
            if not self._standing:
                return TakenOver()
            self._asked = seen.time
            return tuple(ScanPlace(place) for place in self._places)
        scans = {scan.place: scan for scan in seen.scans if scan.time >= self._asked}
        missing = [place for place in self._places if place not in scans]
        if not missing:
            return take_over(self._standing, scans, self._cell, self._scans)
        if seen.time > self._asked + self._scans.patience:
            raise ConfigError(f"the scanner over the {missing[0].replace('_', ' ')} does not answer")
        return ()

    def _move_away(self, hidden: Sequence[str], seen: PalletObservation) -> tuple[Command, ...]:
        outcome = self._aside.step(seen)
        if isinstance(outcome, PursueTarget):
            return (outcome,)
        if outcome is None or (outcome is Event.REACHED and not hidden):
            return ()
        names = " and ".join(hidden).replace("_", " ")
        raise ConfigError(
            f"the arm is over the {names} or too near; bring it beside, so that nothing there is hidden: "
            f"{self._aside.reason or 'its safe position hides it, too'}"
        )


class ShiftGoalRun:
    """Steps a shift from its first observation to its end, and keeps its journal.

    Times in the journal go on where it ended, also where the clock has begun anew.

    Args:
        node: the node that has the goal.
        cell: the cell's physical facts.
        before: the shift so far.
        journal: is written to with every event.
        begin: makes the job, of what stands and of how many boxes are still to come.
        apply: carries out a command.
        states: publishes the states.
        look: brings the arm out of the way, and says what stands.
    """

    def __init__(
        self, node: GoalNode, cell: PalletizingCell, before: WrittenShift, journal: ShiftJournal,
        begin: Callable[[TakenOver, int], ShiftJob], apply: Callable[[Command], None], states: StatePublisher,
        look: TakeOverLook,
    ) -> None:  # fmt: skip
        self._node, self._cell, self._journal, self._apply = node, cell, journal, apply
        self._states, self._begin = states, begin
        self._boxes = int(before.facts["boxes"])
        self._last = before.events[-1].time if before.events else 0.0
        self._came, self._placed, self._settled, self._failed = (set[str]() for _ in range(4))
        self._count(before.events)
        self._look, self._rejected = look, rejected_by_journal(before.events)
        self._job: ShiftJob | None = None
        self._start: float | None = None
        self._offset = self._elapsed = 0.0
        self._halted = ""

    @property
    def _left(self) -> int:
        return self._boxes - len(self._settled)

    def halt(self, reason: str) -> None:
        """Stop safely at the next step."""
        self._halted = reason
        if self._job is not None:
            self._job.halt(reason)

    def step(self, seen: PalletObservation) -> None:
        """Step the shift once; does nothing after its end."""
        if self._job is not None and self._job.is_over:
            return
        if self._start is None:
            self._start, self._offset = seen.time, max(0.0, self._last - seen.time)
        self._elapsed = seen.time - self._start
        if self._node.is_cancel_requested:
            self.halt("canceled on request")
        if self._job is None:
            self._take_over(seen)
            return
        commands = self._job.step(seen)
        self._tell(self._job.events())  # on the disk before anything follows from it
        for command in commands:
            self._apply(command)
        if self._job.is_over:
            self._node.end_goal()

    def result(self) -> RunShift.Result:
        """The action result of a shift that has ended."""
        reason = self._halted if self._job is None else self._job.reason
        return RunShift.Result(
            success=not self._failed and len(self._settled) >= self._boxes, message=reason,
            came=len(self._came), boxes=self._boxes, placed=len(self._placed), execution_time=self._elapsed,
        )  # fmt: skip

    def _take_over(self, seen: PalletObservation) -> None:
        """Look at what stands before any box moves."""
        try:
            found = () if self._halted else self._look.step(seen)
        except ConfigError as error:
            self._halted, found = str(error), ()
        if isinstance(found, TakenOver):
            self._job = self._begin(replace(found, rejected=self._rejected), self._left)
            return
        for command in found:
            self._apply(command)
        if self._halted:
            self._apply(StopArm())  # it may be on its way out of where it hides something
            self._node.end_goal()

    def _tell(self, events: Sequence[ShiftEvent]) -> None:
        """Write events to the journal, publish the states among them, and tell where the shift stands."""
        if not events:
            return
        self._journal.write(replace(event, time=event.time + self._offset) for event in events)
        self._count(events)
        states = [event for event in events if event.kind is EventKind.STATE]
        for event in states:
            self._states.publish(_state_of(event))
        if states:
            now = states[-1]
            self._node.publish_feedback(
                RunShift.Feedback(
                    state=now.data["state"], box=now.box, came=len(self._came), boxes=self._boxes,
                    placed=len(self._placed), elapsed=self._elapsed,
                )
            )  # fmt: skip

    def _count(self, events: Sequence[ShiftEvent]) -> None:
        for event in events:
            if event.kind is EventKind.CAME:
                self._came.add(event.box)
            if event.kind in SETTLED:
                self._settled.add(event.box)
            if event.kind is EventKind.PUT_DOWN and event.place in self._cell.pallets:
                self._placed.add(event.box)
            if event.kind in (EventKind.SKIPPED, EventKind.LOST):
                self._failed.add(event.box)


def _state_of(event: ShiftEvent) -> PalletState:
    message = PalletState(
        state=event.data["state"],
        box=event.box,
        place=event.place,
        event=event.data["event"],
        reason=event.reason,
    )
    message.header.stamp = to_stamp(event.time)
    return message
