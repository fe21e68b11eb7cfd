"""Carries out rearrangements: perceive, plan, and for every action verify, act, verify; replan.

It is a conversation. `start` gives the first request, and each answer gives the next, until there is an
outcome: who answers, and on which clock, is not its concern.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from enum import Enum
from typing import Any

from block_fsm.deviation import Poses, as_seen, astray, disturbed, is_on_line, is_pushed_home
from block_fsm.executor_config import ExecutorConfig
from block_fsm.motions import Motions
from block_fsm.outcome import ExitReason, Outcome, Tally
from block_fsm.requests import Answer, Look, MoveArm, MoveJaw, NoPicture, PlanFor, Request
from block_fsm.surroundings import Surroundings
from block_fsm.task import RearrangeTask
from pack_core.block_sighting import BlockSighting
from pack_core.errors import PackError
from pack_core.jaw import JawCommand, JawState, JawStatus
from pack_core.motion.moves import Path
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.motion.world import CarriedBox
from pack_core.rearrangement.plan import Action, PickPlace, Plan, Push
from pack_core.rearrangement.planar import PlanarPose
from pack_core.rotations import Pose


class Phase(Enum):
    """What the executor is doing."""

    IDLE = "IDLE"
    PERCEIVE = "PERCEIVE"
    PLAN = "PLAN"
    PICK = "PICK"
    PLACE = "PLACE"
    PUSH = "PUSH"
    RETREAT = "RETREAT"
    DONE = "DONE"


class _Ended(Exception):
    def __init__(self, reason: ExitReason, message: str) -> None:
        super().__init__(message)
        self.reason = reason


Asking = Generator[Request, Any, None]


class Executor:
    """One rearrangement.

    Args:
        task: the goals.
        config: tolerances, heights and speeds.
        motions: makes the arm's paths.
        surroundings: makes what they are checked against.
        jaw_force: that blocks are held with [N].

    Attributes:
        phase: what it is doing.
        plan: the newest.
        done: how many of its actions were carried out.
        action: the one under way, from its first move to the pictures after it.
        tally: what was done so far.
        outcome: once it has ended.
    """

    def __init__(
        self,
        task: RearrangeTask,
        config: ExecutorConfig,
        motions: Motions,
        surroundings: Surroundings,
        jaw_force: float,
    ) -> None:
        self._task, self._config, self._motions, self._force = task, config, motions, jaw_force
        self._surroundings, self._opening = surroundings, task.gripper.max_opening
        self.phase = Phase.IDLE
        self.plan: Plan | None = None
        self.done = 0
        self.action: Action | None = None
        self.tally = Tally()
        self.outcome: Outcome | None = None
        self._seen: Poses = {}
        self._failed_grasps = 0
        self._conversation = self._run()

    @property
    def blocks(self) -> tuple[str, ...]:
        """Ids of all blocks."""
        return tuple(self._task.goals)

    def start(self) -> Request:
        """The first request."""
        request = self.answer(None)
        assert request is not None
        return request

    def answer(self, answer: Answer | None) -> Request | None:
        """Take the answer to the last request; the next one, or None when there is an outcome."""
        try:
            return self._conversation.send(answer)
        except StopIteration:
            return None

    def cancel(self, reason: ExitReason, message: str) -> Outcome:
        """End where it is; the arm is for the caller to stop."""
        if self.outcome is None:
            self._conversation.close()
            self._end(reason, message)
        assert self.outcome is not None
        return self.outcome

    def _run(self) -> Asking:
        try:
            yield from self._arrange()
            self._end(ExitReason.ARRANGED, "all blocks are in place")
        except _Ended as end:
            self._end(end.reason, str(end))

    def _arrange(self) -> Asking:
        """Plan and act until there is nothing left to do."""
        yield from self._move(self._motions.look())
        yield from self._look()
        most = None
        while (plan := (yield from self._plan())).actions:
            most = most or 2 * len(plan.actions) + self._config.spare_actions
            predicted = list(plan.states(self._seen))
            for self.done, action in enumerate(plan.actions):
                if self.tally.actions >= most:
                    raise _Ended(ExitReason.NO_PROGRESS, f"{most} actions, and blocks are still out of place")
                if not self._is_as_predicted(action, predicted[self.done]):
                    break
                if not (yield from self._act(as_seen(action, self._seen[action.block]))):
                    break

    def _is_as_predicted(self, action: Action, predicted: Poses) -> bool:
        tolerance = self._config.tolerance
        if isinstance(action, Push) and not is_on_line(action, self._seen[action.block], tolerance):
            return False
        return not astray(self._seen, predicted, tolerance)

    def _act(self, action: Action) -> Generator[Request, Any, bool]:
        """Carry out an action and look; False where the plan no longer holds."""
        before, self.action = self._seen, action
        if isinstance(action, PickPlace):
            self.tally = replace(self.tally, picks=self.tally.picks + 1)
            yield from self._pick_and_place(action)
        else:
            self.tally = replace(self.tally, pushes=self.tally.pushes + 1)
            yield from self._push(action)
        yield from self._look()
        self.action = None
        return self._verify(action, before)

    def _verify(self, action: Action, before: Poses) -> bool:
        tolerance, block = self._config.tolerance, action.block
        if isinstance(action, Push):
            is_there = is_pushed_home(action, self._seen[block], tolerance)
        else:
            is_there = not astray(self._seen, {block: action.end}, tolerance)
        is_calm = not disturbed(before, self._seen, block, tolerance)
        self.tally = replace(
            self.tally, deviations=self.tally.deviations + (not is_there),
            disturbances=self.tally.disturbances + (not is_calm),
        )  # fmt: skip
        return is_there and is_calm

    def _pick_and_place(self, action: PickPlace) -> Asking:
        grip, release = self._motions.grasps(action)
        wide = self._task.gripper.grasp_opening(self._task.side)
        self.phase = Phase.PICK
        yield from self._jaw(wide)
        yield from self._move(self._motions.approach(grip))
        if not (yield from self._hold()):
            yield from self._let_go(grip, wide, action.block, action.start)
            return
        self.phase = Phase.PLACE
        carried = self._surroundings.carried(grip, action.start)
        yield from self._move(self._motions.carry(grip, release), action.block, carried)
        if (yield from self._hold()):
            self._failed_grasps = 0
        yield from self._let_go(release, wide, action.block, action.end)

    def _let_go(self, X_WT: Pose, opening: float, block: str, pose: PlanarPose) -> Asking:
        self.phase = Phase.RETREAT
        yield from self._jaw(opening)
        self._seen = {**self._seen, block: pose}
        yield from self._move(self._motions.retreat(X_WT), touched=block)

    def _push(self, action: Push) -> Asking:
        start, end = self._motions.pushes(action)
        self.phase = Phase.PUSH
        yield from self._jaw(self._task.gripper.push_gap)
        yield from self._move(self._motions.approach(start))
        carried = self._surroundings.carried(end, action.end)
        yield from self._move(self._motions.push(end), action.block, carried)
        self.phase = Phase.RETREAT
        self._seen = {**self._seen, action.block: action.end}
        yield from self._move(self._motions.back_off(start, end), touched=action.block)

    def _hold(self) -> Generator[Request, Any, bool]:
        """Close the fingers; False where they hold nothing."""
        state = yield from self._jaw(self._task.side - self._config.grasp_squeeze)
        if state.status is JawStatus.HOLDING:
            return True
        self._failed_grasps += 1
        self.tally = replace(self.tally, failed_grasps=self.tally.failed_grasps + 1)
        if self._failed_grasps >= self._config.grasps:
            raise _Ended(ExitReason.NO_PROGRESS, f"{self._failed_grasps} grasps in a row held nothing")
        return False

    def _look(self) -> Asking:
        self.phase = Phase.PERCEIVE
        for _ in range(self._config.looks):
            sighting: BlockSighting | NoPicture = yield Look()
            if isinstance(sighting, NoPicture):
                reason = sighting.reason
                continue
            self._seen, reason = sighting.poses, _unclear(sighting)
            if sighting.is_complete:
                return
        raise _Ended(ExitReason.NOT_SEEN, reason)

    def _plan(self) -> Generator[Request, Any, Plan]:
        self.phase = Phase.PLAN
        self.tally = replace(self.tally, plans=self.tally.plans + 1)
        plan: Plan = yield PlanFor(self._task.problem(self._seen))
        self.plan, self.done = plan, 0
        if not plan.is_solved:
            raise _Ended(ExitReason.NO_PLAN, f"{plan.status.name}: {plan.diagnosis.text}")
        return plan

    def _move(
        self, path: Path, moved: str = "", carried: CarriedBox | None = None, *, touched: str = ""
    ) -> Asking:
        """Along a path; `moved` goes with the fingers, and `touched` is what they have just left."""
        obstacles = self._surroundings.among(self._seen, without=moved)
        contacts = frozenset({touched}) if touched else frozenset()
        if carried is not None:
            contacts = self._surroundings.beside(moved, self._seen)
        status: MotionStatus = yield MoveArm(path, self._opening, obstacles, carried, contacts)
        if status.state is not MotionState.REACHED:
            where = "" if status.state is MotionState.REFUSED else f" in '{status.label}'"
            raise _Ended(ExitReason.MOTION_FAILED, f"{status.state.value}{where}: {status.reason}")

    def _jaw(self, opening: float) -> Generator[Request, Any, JawState]:
        state: JawState = yield MoveJaw(JawCommand(opening, self._force))
        self._opening = state.opening
        return state

    def _end(self, reason: ExitReason, message: str) -> None:
        if self.outcome is not None:
            raise PackError("the executor has ended already")
        self.phase = Phase.DONE
        self.outcome = Outcome(reason, message, self.tally, *self._task.errors(self._seen))


def _unclear(sighting: BlockSighting) -> str:
    """What a picture lacks, in words."""
    lacks = (("not seen", sighting.missing), ("seen more than once", sighting.doubled))
    return "; ".join(f"{what}: {', '.join(names)}" for what, names in lacks if names)
