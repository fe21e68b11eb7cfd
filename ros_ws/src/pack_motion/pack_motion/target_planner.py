"""Plans a target: within the arm's reach and limits, and clear of obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.motion.moves import JointMove, Path
from pack_core.motion.target import MotionTarget
from pack_core.robots.joint_properties import JointLimits
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import ClearanceCheck, Surrounding
from pack_motion.clearance.transfer import TransferPlanner
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.refusal import MoveRefused
from pack_motion.reference.trajectory import JointState

TURN = 2.0 * np.pi


@dataclass(frozen=True)
class PreparedTarget:
    """A target with its plan, or why there is none."""

    target: MotionTarget
    plan: MotionPlan | None
    reason: str


class TargetPlanner:
    """Plans for one arm; keeps no state.

    Args:
        arm: the arm that moves.
        clearance: smallest allowed distance to obstacles in moves that are checked [m].
    """

    def __init__(self, arm: MotionArm, clearance: float) -> None:
        self._arm = arm
        self._paths = PathPlanner(arm)
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
    """The state with joints that are beyond their range turned back by whole turns.

    A static reference knows no way between its goals, and its joints may wind up beyond their ranges where
    nothing stops them. Plans must begin within.
    """
    is_beyond = (state.q < limits.lower) | (state.q > limits.upper)
    q = state.q - np.where(is_beyond, TURN * np.round(state.q / TURN), 0.0)
    return JointState(np.clip(q, limits.lower, limits.upper), state.v, state.a)
