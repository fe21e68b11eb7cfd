"""Plans a target within the arm's reach and limits and clear of obstacles, also in a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionTarget
from pack_core.robots.joint_properties import JointLimits
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import ClearanceCheck, Surrounding
from pack_motion.clearance.transfer import TransferPlanner
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState, MoveRefused


@dataclass(frozen=True)
class PreparedTarget:
    """A target with its plan, or why there is none."""

    target: MotionTarget
    plan: MotionPlan | None
    reason: str


class TargetPlanner:
    """Plans for one arm; a plan does not depend on earlier ones.

    Args:
        arm: the arm that moves.
        clearance: smallest allowed distance to obstacles in moves that are checked [m].
        share: of the arm's velocity and acceleration limits that references use.
    """

    def __init__(self, arm: MotionArm, clearance: float, share: float) -> None:
        self._arm = arm
        self._paths = PathPlanner(arm, share)
        self._check = ClearanceCheck(arm, clearance)
        self._transfers = TransferPlanner(arm, self._paths, self._check)

    def plan(self, start: JointState, target: MotionTarget) -> MotionPlan:
        """The plan for a target from `start`.

        Raises:
            MoveRefused: there is no plan; the text says why.
        """
        around = Surrounding(target.obstacles, target.carried, target.contacts, target.opening)
        if not isinstance(target.move, Path):
            return self._transfers.plan(start, target.move, around)
        plan = self._paths.plan(start, target.move)
        conflict = self._check.conflict(plan, around) if target.is_checked else None
        if conflict is not None:
            raise MoveRefused(conflict.text)
        return plan

    def prepare(
        self, start: JointState, target: MotionTarget, others: Sequence[MotionTarget]
    ) -> PreparedTarget:
        """The target with a plan from `start`, or with the reason why there is none.

        Args:
            start: state of the joints at the start.
            target: the wanted target.
            others: targets with the same end, which are tried where the first one is refused.
        """
        refusals = []
        for way in (target, *others):
            try:
                return PreparedTarget(target, self.plan(start, way), "")
            except MoveRefused as refusal:
                refusals.append(str(refusal))
        return PreparedTarget(target, None, refusals[0])

    def stop(self, start: JointState) -> MotionPlan:
        """The fastest stop from `start`."""
        trajectory = self._paths.stop(start)
        goal = JointMove(trajectory.end.q, label="stop")
        return MotionPlan(trajectory, (goal,), self._arm.chain.forward(trajectory.end.q))


def unwound(state: JointState, limits: JointLimits) -> JointState:
    """The state at rest, with joints that are beyond their range turned back by whole turns.

    A static reference knows no way between its goals. Its joints may wind up beyond their ranges, where
    nothing stops them, and move faster than they could be stopped within. Plans, of which it takes the goals
    alone, must begin within their limits.
    """
    return JointState.at_rest(np.clip(limits.unwound(state.q), limits.lower, limits.upper))


class PlanningThread:
    """Passes each target to `prepare`, one at a time; the newest replaces one that is still waiting.

    Args:
        prepare: plans a target.
        on_error: called with an unexpected exception of `prepare`.
    """

    def __init__(
        self, prepare: Callable[[MotionTarget], PreparedTarget], on_error: Callable[[Exception], None]
    ) -> None:
        self._prepare, self._on_error = prepare, on_error
        self._condition = threading.Condition()
        self._target: MotionTarget | None = None
        self._prepared: PreparedTarget | None = None
        self._is_ended = False
        self._thread = threading.Thread(target=self._run, name="planning", daemon=True)
        self._thread.start()

    def submit(self, target: MotionTarget) -> None:
        """Plan this target next; the result of an earlier one is dropped."""
        with self._condition:
            self._target, self._prepared = target, None
            self._condition.notify()

    def result(self) -> PreparedTarget | None:
        """The target planned since the last call; None while there is none."""
        with self._condition:
            prepared, self._prepared = self._prepared, None
            return prepared

    def end(self) -> None:
        """Finish the target that is being planned, and end the thread."""
        with self._condition:
            self._is_ended = True
            self._condition.notify()
        self._thread.join()

    def _run(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._target is not None or self._is_ended)
                if self._is_ended:
                    return
                target, self._target = self._target, None
            assert target is not None
            try:
                prepared = self._prepare(target)
            except Exception as error:
                self._on_error(error)
                prepared = PreparedTarget(target, None, str(error))
            with self._condition:
                if self._target is None:  # otherwise a newer target waits and this result is dropped
                    self._prepared = prepared
