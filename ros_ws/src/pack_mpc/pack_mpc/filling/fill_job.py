"""Filling a container from a list: one object after the other is handed over, packed and let go.

A job is written down as what it does, one thing after the other. It runs as a generator: `step` brings it
the newest observation, and it goes on to the next moment at which it has to wait. What it waits for is either
time, while the arm follows a motion, or the answer to a request that the caller passes to the cell.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias, TypeVar

import numpy as np

from pack_core.joints import JointSample, Setpoints
from pack_core.packing.arrangement import Arrangement
from pack_core.packing.cell import PackingCell
from pack_core.packing.exit_reason import PackingExitReason
from pack_core.packing.free_space import base_height, is_packed
from pack_core.packing.model import UPSIDE_DOWN
from pack_core.packing.objects import ObjectModel, SceneItem
from pack_core.packing.packing_list import PackingList, handed_over
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, from_yaw, multiply, rotate, yaw_of
from pack_core.states import SceneState
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.fill_report import FilledObject, FillReport, fill_of
from pack_mpc.filling.requests import Arrange, FillRequest, Grip, Judge, Pack, Packed, Present, Presented
from pack_mpc.filling.tool_motion import Leg, ToolArm, legs
from pack_mpc.outcome import PackingOutcome
from pack_mpc.stages import UP, nearest_heading

OVERLAP = 0.35
"""Share of a leg during which the next one begins already, well above everything."""
PAUSE = 0.1
"""Time after a motion until the arm has come to rest [s]."""
A = TypeVar("A")


class FillStage(Enum):
    """What a fill job does."""

    ARRANGE = "arrange"
    PRESENT = "present"
    PICK = "pick"
    PACK = "pack"
    SET_DOWN = "set_down"
    RELEASE = "release"
    PUT_ASIDE = "put_aside"
    DONE = "done"


@dataclass(frozen=True)
class FillObservation:
    """What a step of the job sees.

    Attributes:
        joints: newest sample of the joints.
        scene: newest estimate of the objects.
        force: newest external force on cup or held object `(3,)` [N].
        is_gripped: whether the pump holds an object: the vacuum is seen.
        answer: the answer to the last request; None while there is none.
    """

    joints: JointSample
    scene: SceneState
    force: Array
    is_gripped: bool
    answer: object | None = None


@dataclass(frozen=True)
class FillCommand:
    """What the caller shall do now.

    Attributes:
        setpoints: what the arm shall follow; None: nothing new, the driver holds it.
        request: to be passed on, once.
    """

    setpoints: Setpoints | None = None
    request: FillRequest | None = None


Steps: TypeAlias = Generator[FillCommand, FillObservation, A]
Until: TypeAlias = Callable[[FillObservation], bool]


class FillJob:
    """Fills the container of a scene from a list.

    Args:
        given: the list.
        cell: the cell's physical facts.
        config: speeds, heights and forces.
        scene: the cell as described at the start.
    """

    def __init__(self, given: PackingList, cell: PackingCell, config: FillConfig, scene: Scene) -> None:
        self._cell, self._config, self.scene = cell, config, scene
        self._remaining: list[ObjectModel] = list(given.objects)
        self._arm = ToolArm(cell)
        self._tallest = max(2.0 * float(item.half_extents[2]) for item in given.objects)
        self._planned: Mapping[str, Pose] = {}
        self._steps: Steps[None] | None = None
        self.stage, self.current = FillStage.ARRANGE, ""
        self.report = FillReport()
        self.is_done = False

    @property
    def remaining(self) -> int:
        """How many objects are still to come."""
        return len(self._remaining)

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
        while self._remaining:
            self.stage, self.current = FillStage.ARRANGE, ""
            arrangement, seen = yield from self._ask(seen, self._arrange, Arrangement)
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
        self.report.message = f"{packed} of {given} objects packed"

    @property
    def _arrange(self) -> Arrange:
        return Arrange(tuple(self._remaining), self._planned)

    def _handle(self, seen: FillObservation, item: ObjectModel, X_WN: Pose | None) -> Steps[FillObservation]:
        """Take one object from its hand-over to its rest."""
        self.stage, self.current, start = FillStage.PRESENT, item.name, seen.joints.time
        seen = yield from self._make_way(seen)
        presented, seen = yield from self._ask(seen, Present(handed_over(item, self._cell)), Presented)
        if presented.scene is None:
            self._leave(item.name, presented.reason, start)
            return seen
        self.scene = presented.scene
        if X_WN is None:
            reason, seen = yield from self._ask(seen, Judge(), str)
            if reason:
                self._leave(item.name, reason, start)
                return seen
        self.stage = FillStage.PICK
        reason, seen = yield from self._pick(seen)
        if reason:
            self._note(item.name, start, seen, reason)
            return (yield from self._rise(seen, self._config.clearance))
        grip = self._arm.cup(seen.joints.q).inverse() @ seen.scene.objects[item.name].X_WO
        self.stage = FillStage.PACK
        packed, seen = yield from self._ask(seen, Pack(X_WN, grip), Packed)
        outcome = packed.outcome
        if not seen.is_gripped:
            self._note(item.name, start, seen, outcome.message, outcome, has_fault=True)
            return (yield from self._rise(seen, self._config.clearance))
        fault = outcome.exit_reason is PackingExitReason.FORCE
        reason = "" if outcome.success else f"{outcome.exit_reason.value}: {outcome.message}"
        if not reason:
            self.stage = FillStage.SET_DOWN
            reason, seen = yield from self._set_down(seen, packed.X_WN)
        if reason:
            self.stage = FillStage.PUT_ASIDE
            seen = yield from self._put_aside(seen)
            self._note(item.name, start, seen, f"put aside: {reason}", outcome, has_fault=fault)
            return seen
        self.stage = FillStage.RELEASE
        reason, seen = yield from self._release(seen)
        self._note(item.name, start, seen, reason, outcome)
        return seen

    def _pick(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Grip the object that was handed over, and lift it a little; returns why it failed, if it did."""
        item, config = self.scene.new_object, self._config
        announced = self._cell.hand_over.pose_of(item)
        seen = yield from self._go_over(seen, item, announced)
        found, seen = yield from self._wait(seen, lambda s: item.name in s.scene.objects, config.sight_time)
        if not found:
            return f"no camera has seen '{item.name}' at the hand-over place", seen
        for _ in range(config.grip_tries):
            X_WN = seen.scene.objects[item.name].X_WO
            seen = yield from self._go_over(seen, item, X_WN)
            refusal, seen = yield from self._touch(seen)
            if not refusal:
                break
            seen = yield from self._rise(seen, config.approach)
        else:
            return f"could not be gripped: {refusal}", seen
        seen = yield from self._rise(seen, config.lift, speed=config.carry_speed)
        return "" if seen.is_gripped else "slipped off the cup when it was lifted", seen

    def _touch(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Come down until the cup touches the object, then close the pump and wait for the vacuum."""
        config = self._config
        touches = self._contact(seen)
        seen = yield from self._down(seen, config.approach + config.overshoot, touches)
        refusal, seen = yield from self._ask(seen, Grip(close=True), str)
        if not refusal:
            found, seen = yield from self._wait(seen, lambda s: s.is_gripped, config.sight_time)
            refusal = "" if found else "no vacuum was seen"
        return refusal, seen

    def _set_down(self, seen: FillObservation, goal: Pose | None) -> Steps[tuple[str, FillObservation]]:
        """Bring the packed object the last millimetres to its place and down to the base.

        Returns:
            Why it must not be let go there; empty if it stands or leans safely.
        """
        item, config = self.scene.new_object, self._config
        _, seen = yield from self._wait(seen, _never, config.calm_time)
        aside = np.zeros(3)
        if goal is not None:
            aside[:2] = goal.p[:2] - seen.scene.objects[item.name].X_WO.p[:2]
            aside *= min(1.0, config.shift / max(float(np.linalg.norm(aside)), 1e-9))
        resists = self._contact(seen, config.press_force)
        way = aside - np.array([0.0, 0.0, max(_height(seen, item), 0.0) + config.overshoot / 2])
        seen = yield from self._move(
            seen, legs([way], config.touch_speed),
            until=resists,
        )  # fmt: skip
        X_WN = seen.scene.objects[item.name].X_WO
        tilt = float(np.rad2deg(np.arccos(np.clip(rotate(X_WN.q, UP)[2], -1.0, 1.0))))
        if not is_packed(self.scene, X_WN):
            return "it is not between the walls", seen
        if _height(seen, item) > config.release_height:
            return f"its lower end is {1e3 * _height(seen, item):.0f} mm over the base", seen
        if tilt > config.release_tilt_deg:
            return f"it is tilted by {tilt:.0f} degrees", seen
        return "", seen

    def _release(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Open the pump, draw back without dragging, and see where the object rests."""
        item, config = self.scene.new_object, self._config
        _, seen = yield from self._ask(seen, Grip(close=False), str)
        _, seen = yield from self._wait(seen, lambda s: not s.is_gripped, config.sight_time)
        drags = self._contact(seen, config.retreat_force)
        dragged = False

        def note(s: FillObservation) -> bool:
            nonlocal dragged
            dragged |= drags(s)
            return False

        seen = yield from self._rise(seen, config.clearance, note, speed=config.carry_speed)
        state = seen.scene.objects[item.name]
        is_still = float(np.linalg.norm(state.v_WO_W)) < config.rest_speed
        if not is_packed(self.scene, state.X_WO):
            return "it is not in the container", seen
        return ("" if is_still else "it was still moving") + ("the cup dragged" if dragged else ""), seen

    def _put_aside(self, seen: FillObservation) -> Steps[FillObservation]:
        """Carry the held object back to the hand-over place and let it go there."""
        item, config = self.scene.new_object, self._config
        bottom = _height(seen, item)
        seen = yield from self._rise(
            seen, max(self.scene.rim + config.clearance - bottom, 0.0), speed=config.carry_speed
        )
        place = self._cell.hand_over.pose_of(item)
        X_WN = seen.scene.objects[item.name].X_WO if item.name in seen.scene.objects else place
        across = np.array([*(place.p[:2] - X_WN.p[:2]), 0.0])
        height = _height(seen, item) - config.approach
        down = np.array([0.0, 0.0, -max(height, 0.0)])
        seen = yield from self._move(seen, legs([across, down], config.carry_speed))
        touches = self._contact(seen)
        seen = yield from self._down(
            seen, config.approach + config.overshoot,
            lambda s: touches(s) or _height(s, item) < config.standing,
        )  # fmt: skip
        _, seen = yield from self._ask(seen, Grip(close=False), str)
        _, seen = yield from self._wait(seen, lambda s: not s.is_gripped, config.sight_time)
        return (yield from self._rise(seen, config.clearance))

    # motions

    def _go_over(self, seen: FillObservation, item: SceneItem, X_WN: Pose) -> Steps[FillObservation]:
        """Bring the empty cup over an object at X_WN, upright above everything on the way."""
        X_WT, config = self._arm.cup(seen.joints.q), self._config
        # near the home heading, so that the last joint can turn either way afterwards
        yaw = nearest_heading(item, yaw_of(X_WN.q), self._arm.home_heading)
        q_WT = multiply(from_yaw(yaw), np.array(UPSIDE_DOWN))
        top = float(X_WN.p[2] + item.half_extents[2])
        goal = np.array([*X_WN.p[:2], top + config.approach])
        across = np.array([*(goal[:2] - X_WT.p[:2]), 0.0])
        if np.linalg.norm(across) < config.approach:
            ways = [goal - X_WT.p]
        else:
            travel = max(self._highest + config.clearance, goal[2], float(X_WT.p[2]))
            up, down = travel - float(X_WT.p[2]), float(goal[2]) - travel
            ways = [np.array([0.0, 0.0, up]), across, np.array([0.0, 0.0, down])]
        ways = [way for way in ways if np.linalg.norm(way) > 1e-4] or [np.zeros(3)]
        return (yield from self._move(seen, legs(ways, config.speed, OVERLAP), q_WT))

    def _make_way(self, seen: FillObservation) -> Steps[FillObservation]:
        """Raise the empty cup where it stands in the way of what is handed over next."""
        p_WT = self._arm.cup(seen.joints.q).p
        aside = float(np.linalg.norm(p_WT[:2] - np.array(self._cell.hand_over.centre)))
        missing = self._tallest + self._config.clearance - float(p_WT[2])
        if aside > self._config.hand_over_reach or missing <= 0.0:
            return seen
        return (yield from self._rise(seen, missing))

    @property
    def _highest(self) -> float:
        """Height of the tallest thing that the empty cup may meet [m]."""
        return max(self.scene.rim, 2.0 * float(self.scene.new_object.half_extents[2]))

    def _down(self, seen: FillObservation, way: float, until: Until) -> Steps[FillObservation]:
        path = [Leg(np.array([0.0, 0.0, -way]), 0.0, 1.875 * way / self._config.touch_speed)]
        return (yield from self._move(seen, path, until=until))

    def _rise(
        self, seen: FillObservation, way: float, until: Until | None = None, speed: float | None = None
    ) -> Steps[FillObservation]:
        path = legs([np.array([0.0, 0.0, way])], speed or self._config.speed)
        return (yield from self._move(seen, path, until=until))

    def _move(
        self, seen: FillObservation, path: list[Leg], q_WT: Array | None = None, until: Until | None = None
    ) -> Steps[FillObservation]:
        """Follow a path to its end, or until a condition holds."""
        motion = self._arm.plan(seen.joints.q, seen.joints.time, path, q_WT)
        while seen.joints.time < motion.end + PAUSE:
            if until is not None and until(seen):
                return seen
            seen = yield FillCommand(motion.setpoints(seen.joints.time))
        return seen

    def _wait(
        self, seen: FillObservation, until: Until, longest: float
    ) -> Steps[tuple[bool, FillObservation]]:
        """Wait for a condition, the arm held by the driver; returns whether it came to hold."""
        start = seen.joints.time
        while not until(seen):
            if seen.joints.time - start > longest:
                return False, seen
            seen = yield FillCommand()
        return True, seen

    def _ask(
        self, seen: FillObservation, request: FillRequest, kind: type[A]
    ) -> Steps[tuple[A, FillObservation]]:
        """Pass a request on and wait for its answer."""
        seen = yield FillCommand(request=request)
        while seen.answer is None:
            seen = yield FillCommand()
        assert isinstance(seen.answer, kind), f"{seen.answer!r} does not answer {request!r}"
        return seen.answer, seen

    def _contact(self, seen: FillObservation, force: float | None = None) -> Until:
        """A condition: the external force has changed by more than `force` [N] from what it is now."""
        tare, limit = seen.force, force or self._config.touch_force
        return lambda s: float(np.linalg.norm(s.force - tare)) > limit

    # report

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


def _never(_: FillObservation) -> bool:
    return False


def _height(seen: FillObservation, item: SceneItem) -> float:
    """Height of an object's lowest point over the table [m]."""
    return base_height(item, seen.scene.objects[item.name].X_WO)
