"""Filling a container from a list: one object after the other is handed over, packed and let go."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pack_core.errors import PackError
from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import Fill, fill_of, is_packed
from pack_core.packing.goals import Arrangement, PackingExitReason
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingList, handed_over
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_core.tasks.steps import Steps, TaskRun
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.object_handling import ObjectHandling
from pack_mpc.filling.requests import (
    Arrange,
    FillCommand,
    FillObservation,
    FillPort,
    FillStage,
    Judge,
    Pack,
    Packed,
    Present,
    Presented,
)
from pack_mpc.task.task import PackingOutcome


@dataclass(frozen=True)
class FilledObject:
    """One object of a list.

    Attributes:
        name: of the object.
        is_packed: whether it was let go in the container and rests there, as seen.
        reason: why not, or how it ended, in words.
        exit_reason: of the packing goal; empty if there was none.
        start: time at which it was handed over [s].
        duration: from then until the arm was free again [s].
        force_peak: largest external force on it [N].
        placements: how many placements were tried.
        X_WO: where it was seen at the end; None if it was not.
        has_fault: whether it was dropped, or a force stop ended its goal.
    """

    name: str
    is_packed: bool
    reason: str
    exit_reason: str
    start: float
    duration: float
    force_peak: float
    placements: int
    X_WO: Pose | None = None
    has_fault: bool = False

    def row(self) -> dict[str, Any]:
        """Plain values for files and tables."""
        at = None if self.X_WO is None else [*self.X_WO.p.tolist(), *self.X_WO.q.tolist()]
        return {
            "name": self.name, "packed": self.is_packed, "reason": self.reason,
            "exit_reason": self.exit_reason, "start": self.start, "duration": self.duration,
            "force_peak": self.force_peak, "placements": self.placements, "pose": at,
            "fault": self.has_fault,
        }  # fmt: skip


@dataclass
class FillReport:
    """A job's objects in the order in which they came, and the fill after each."""

    objects: list[FilledObject] = field(default_factory=list)
    fills: list[tuple[float, Fill]] = field(default_factory=list)
    message: str = ""

    @property
    def packed(self) -> list[FilledObject]:
        """The objects that rest in the container."""
        return [row for row in self.objects if row.is_packed]

    @property
    def has_fault(self) -> bool:
        """Whether an object was dropped or a force stop ended a goal."""
        return any(row.has_fault for row in self.objects)


class FillJob:
    """Fills the container of a scene from a list.

    Args:
        given: the list.
        cell: the cell's physical facts.
        config: speeds, heights and forces.
        scene: the cell as described at the start.

    Attributes:
        stage: what is done now.
        current: name of the object that is handled; empty between two objects.
        report: what became of the objects so far.
        fault: why the job ended before its list did; empty if it did not.
        is_done: whether the job has ended.
    """

    def __init__(self, given: PackingList, cell: PackingCell, config: FillConfig, scene: Scene) -> None:
        self._cell, self._config = cell, config
        self._remaining: list[ObjectModel] = list(given.objects)
        tallest = max(2.0 * float(item.half_extents[2]) for item in given.objects)
        self._port = FillPort()
        self._moves = CupMoves(self._port, cell, config, scene, tallest)
        self._planned: Mapping[str, Pose] = {}
        self._task = TaskRun(self._steps())
        self.stage, self.current = FillStage.ARRANGE, ""
        self.report, self.fault = FillReport(), ""
        self.is_done = False

    @property
    def scene(self) -> Scene:
        """The cell as described last."""
        return self._moves.scene

    def follow(self, scene: Scene) -> None:
        """Go on with what is described now."""
        self._moves.scene = scene

    @property
    def remaining(self) -> list[str]:
        """Names of the objects that are still to come."""
        return [item.name for item in self._remaining]

    def step(self, seen: FillObservation) -> FillCommand:
        """Go on with the newest observation."""
        self._port.seen, self._port.command = seen, FillCommand()
        self._task.go_on()
        if self._task.is_over and not self.is_done:
            self.is_done, self.stage, self.current = True, FillStage.DONE, ""
            if self._task.failure:
                self.fault = self.report.message = self._task.failure
        return self._port.command

    def _steps(self) -> Steps[None]:
        self._note_fill()
        while self._remaining and not self.fault:
            self.stage, self.current = FillStage.ARRANGE, ""
            request = Arrange(tuple(self._remaining), self._planned)
            arrangement = yield from self._port.ask(request, Arrangement)
            self._planned = arrangement.poses
            for name, reason in arrangement.refused.items():
                self._leave(name, reason, self._port.time)
            if not arrangement.order:
                break
            item = self._listed(arrangement.order[0])
            self._remaining.remove(item)
            yield from self._handle(item, arrangement.poses.get(item.name))
            self._note_fill()
        packed, given = len(self.report.packed), len(self.report.objects)
        self.report.message = self.fault or f"{packed} of {given} objects packed"

    def _listed(self, name: str) -> ObjectModel:
        for item in self._remaining:
            if item.name == name:
                return item
        raise PackError(f"the planner's next object, '{name}', is none of {', '.join(self.remaining)}")

    def _handle(self, item: ObjectModel, X_WN: Pose | None) -> Steps[None]:
        """Take one object from its hand-over to its rest."""
        self.stage, self.current, start = FillStage.PRESENT, item.name, self._port.time
        yield from self._moves.make_way()
        presented = yield from self._port.ask(Present(handed_over(item, self._cell)), Presented)
        if presented.scene is None:
            self._leave(item.name, presented.reason, start)
            return
        self.follow(presented.scene)
        handling = ObjectHandling(self._moves, self._cell, self._config)
        if X_WN is None:
            reason = yield from self._port.ask(Judge(), str)
            if reason:
                self._leave(item.name, reason, start)
                return
        self.stage = FillStage.PICK
        reason = yield from handling.pick()
        if reason:
            self._note(item.name, start, reason)
            yield from self._moves.rise(self._config.clearance)
        else:
            yield from self._pack(item, X_WN, handling, start)

    def _pack(
        self, item: ObjectModel, X_WN: Pose | None, handling: ObjectHandling, start: float
    ) -> Steps[None]:
        """Pack the held object and let it go, or put it aside."""
        grip = self._moves.cup.inverse() @ self._port.pose_of(item.name)
        for tries_left in reversed(range(self._config.pack_tries)):
            self.stage = FillStage.PACK
            packed = yield from self._port.ask(Pack(X_WN, grip), Packed)
            outcome = packed.outcome
            if not self._port.seen.is_gripped:
                self._note(item.name, start, outcome.message, outcome, has_fault=True)
                yield from self._moves.rise(self._config.clearance)
                return
            if not outcome.success:
                reason = f"{outcome.exit_reason.value}: {outcome.message}"
                break
            self.stage = FillStage.SET_DOWN
            reason = yield from handling.set_down(packed.X_WN)
            if not reason:
                self.stage = FillStage.RELEASE
                reason = yield from handling.release()
                if self._port.seen.is_gripped:
                    self.fault = f"'{item.name}' is still held: {reason}"
                self._note(item.name, start, reason, outcome, has_fault=bool(self.fault))
                return
            if tries_left:
                yield from handling.take_out()
                X_WN = yield from self._another_place(item)
                if X_WN is None:
                    break
        self.stage = FillStage.PUT_ASIDE
        still_held = yield from handling.put_aside()
        if still_held:
            self.fault = f"'{item.name}' is still held ({reason}): {still_held}"
        has_fault = bool(still_held) or outcome.exit_reason is PackingExitReason.FORCE
        note = f"still held: {still_held}" if still_held else f"put aside: {reason}"
        self._note(item.name, start, note, outcome, has_fault=has_fault)

    def _another_place(self, item: ObjectModel) -> Steps[Pose | None]:
        """Where the held object may stand instead, as what is in the container stands now."""
        request = Arrange((item, *self._remaining), self._planned)
        arrangement = yield from self._port.ask(request, Arrangement)
        self._planned = arrangement.poses
        return arrangement.poses.get(item.name)

    def _note(
        self, name: str, start: float, reason: str, outcome: PackingOutcome | None = None, *,
        has_fault: bool = False,
    ) -> None:  # fmt: skip
        seen = self._port.seen
        state = seen.scene.objects.get(name)
        X_WO = None if state is None else state.X_WO
        packed = X_WO is not None and is_packed(self.scene, X_WO) and not seen.is_gripped and not has_fault
        self.report.objects.append(
            FilledObject(
                name, packed, reason or "packed", outcome.exit_reason.value if outcome else "", start,
                seen.joints.time - start, outcome.force_peak if outcome else 0.0,
                outcome.placements if outcome else 0, X_WO, has_fault,
            )
        )  # fmt: skip

    def _leave(self, name: str, reason: str, time: float) -> None:
        """Note an object that was not even picked up."""
        self._remaining = [item for item in self._remaining if item.name != name]
        self.report.objects.append(FilledObject(name, False, f"put aside: {reason}", "", time, 0.0, 0.0, 0))

    def _note_fill(self) -> None:
        poses = self._port.seen.scene.poses()
        items = [item for item in (*self.scene.objects, self.scene.new_object) if item.name in poses]
        standing = [(item, poses[item.name]) for item in items if is_packed(self.scene, poses[item.name])]
        self.report.fills.append((self._port.time, fill_of(self.scene.container, standing)))
