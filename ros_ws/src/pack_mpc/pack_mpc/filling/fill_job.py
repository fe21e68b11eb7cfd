"""Filling a container from a list: one object after the other is handed over, packed and let go."""

from __future__ import annotations

from collections.abc import Mapping

from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import fill_of, is_packed
from pack_core.packing.goals import Arrangement, PackingExitReason
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingList, handed_over
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.fill_report import FilledObject, FillReport
from pack_mpc.filling.object_handling import ObjectHandling
from pack_mpc.filling.requests import Arrange, Judge, Pack, Packed, Present, Presented
from pack_mpc.filling.steps import FillCommand, FillObservation, FillStage, Steps, ask
from pack_mpc.task.task import PackingOutcome


class FillJob:
    """Fills the container of a scene from a list.

    Args:
        given: the list.
        cell: the cell's physical facts.
        config: speeds, heights and forces.
        scene: the cell as described at the start.

    Attributes:
        scene: the cell as described last.
        stage: what is done now.
        current: name of the object that is handled; empty between two objects.
        report: what became of the objects so far.
        fault: why the job ended before its list did; empty if it did not.
        is_done: whether the job has ended.
    """

    def __init__(self, given: PackingList, cell: PackingCell, config: FillConfig, scene: Scene) -> None:
        self._cell, self._config, self.scene = cell, config, scene
        self._remaining: list[ObjectModel] = list(given.objects)
        tallest = max(2.0 * float(item.half_extents[2]) for item in given.objects)
        self._moves = CupMoves(cell, config, scene, tallest)
        self._planned: Mapping[str, Pose] = {}
        self._steps: Steps[None] | None = None
        self.stage, self.current = FillStage.ARRANGE, ""
        self.report, self.fault = FillReport(), ""
        self.is_done = False

    @property
    def remaining(self) -> list[str]:
        """Names of the objects that are still to come."""
        return [item.name for item in self._remaining]

    def step(self, seen: FillObservation) -> FillCommand:
        """Go on with the newest observation."""
        if self.is_done:
            return FillCommand()
        try:
            if self._steps is None:
                self._steps = self._run(seen)
                return next(self._steps)
            return self._steps.send(seen)
        except StopIteration:
            self.is_done, self.stage, self.current = True, FillStage.DONE, ""
            return FillCommand()

    def _run(self, seen: FillObservation) -> Steps[None]:
        self._note_fill(seen)
        while self._remaining and not self.fault:
            self.stage, self.current = FillStage.ARRANGE, ""
            request = Arrange(tuple(self._remaining), self._planned)
            arrangement, seen = yield from ask(seen, request, Arrangement)
            self._planned = arrangement.poses
            for name, reason in arrangement.refused.items():
                self._leave(name, reason, seen.joints.time)
            if not arrangement.order:
                break
            item = next(item for item in self._remaining if item.name == arrangement.order[0])
            self._remaining.remove(item)
            seen = yield from self._handle(seen, item, arrangement.poses.get(item.name))
            self._note_fill(seen)
        packed, given = len(self.report.packed), len(self.report.objects)
        self.report.message = self.fault or f"{packed} of {given} objects packed"

    def _handle(self, seen: FillObservation, item: ObjectModel, X_WN: Pose | None) -> Steps[FillObservation]:
        """Take one object from its hand-over to its rest."""
        self.stage, self.current, start = FillStage.PRESENT, item.name, seen.joints.time
        seen = yield from self._moves.make_way(seen)
        presented, seen = yield from ask(seen, Present(handed_over(item, self._cell)), Presented)
        if presented.scene is None:
            self._leave(item.name, presented.reason, start)
            return seen
        self.scene = self._moves.scene = presented.scene
        handling = ObjectHandling(self._moves, self._cell, self._config)
        if X_WN is None:
            reason, seen = yield from ask(seen, Judge(), str)
            if reason:
                self._leave(item.name, reason, start)
                return seen
        self.stage = FillStage.PICK
        reason, seen = yield from handling.pick(seen)
        if reason:
            self._note(item.name, start, seen, reason)
            return (yield from self._moves.rise(seen, self._config.clearance))
        return (yield from self._pack(seen, item, X_WN, handling, start))

    def _pack(
        self, seen: FillObservation, item: ObjectModel, X_WN: Pose | None, handling: ObjectHandling,
        start: float,
    ) -> Steps[FillObservation]:  # fmt: skip
        """Pack the held object and let it go, or put it aside."""
        grip = self._moves.arm.cup(seen.joints.q).inverse() @ seen.scene.objects[item.name].X_WO
        for tries_left in reversed(range(self._config.pack_tries)):
            self.stage = FillStage.PACK
            packed, seen = yield from ask(seen, Pack(X_WN, grip), Packed)
            outcome = packed.outcome
            if not seen.is_gripped:
                self._note(item.name, start, seen, outcome.message, outcome, has_fault=True)
                return (yield from self._moves.rise(seen, self._config.clearance))
            if not outcome.success:
                reason = f"{outcome.exit_reason.value}: {outcome.message}"
                break
            self.stage = FillStage.SET_DOWN
            reason, seen = yield from handling.set_down(seen, packed.X_WN)
            if not reason:
                self.stage = FillStage.RELEASE
                reason, seen = yield from handling.release(seen)
                self._note(item.name, start, seen, reason, outcome)
                return seen
            if tries_left:
                seen = yield from handling.take_out(seen)
                X_WN, seen = yield from self._another_place(seen, item)
                if X_WN is None:
                    break
        self.stage = FillStage.PUT_ASIDE
        still_held, seen = yield from handling.put_aside(seen)
        if still_held:
            self.fault = f"'{item.name}' is still held ({reason}): {still_held}"
        has_fault = bool(still_held) or outcome.exit_reason is PackingExitReason.FORCE
        note = f"still held: {still_held}" if still_held else f"put aside: {reason}"
        self._note(item.name, start, seen, note, outcome, has_fault=has_fault)
        return seen

    def _another_place(
        self, seen: FillObservation, item: ObjectModel
    ) -> Steps[tuple[Pose | None, FillObservation]]:
        """Where the held object may stand instead, as what is in the container stands now."""
        request = Arrange((item, *self._remaining), self._planned)
        arrangement, seen = yield from ask(seen, request, Arrangement)
        self._planned = arrangement.poses
        return arrangement.poses.get(item.name), seen

    def _note(
        self, name: str, start: float, seen: FillObservation, reason: str,
        outcome: PackingOutcome | None = None, *, has_fault: bool = False,
    ) -> None:  # fmt: skip
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

    def _note_fill(self, seen: FillObservation) -> None:
        poses = seen.scene.poses()
        items = [item for item in (*self.scene.objects, self.scene.new_object) if item.name in poses]
        standing = [(item, poses[item.name]) for item in items if is_packed(self.scene, poses[item.name])]
        self.report.fills.append((seen.joints.time, fill_of(self.scene.container, standing)))
