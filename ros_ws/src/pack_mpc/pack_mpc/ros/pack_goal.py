"""A packing goal in the running cell: its session, with placements from the planner."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pack_interfaces.action import PackObject

from pack_core.joints import Setpoints
from pack_core.packing.exit_reason import PackingExitReason
from pack_core.packing.method import PackingMethod
from pack_core.rotations import Array
from pack_mpc.controller import ControlPlan
from pack_mpc.ros.placement_client import PlacementClient
from pack_mpc.ros.status import to_feedback
from pack_mpc.session import PackingObservation, PackingSession


@dataclass(frozen=True)
class GoalTurn:
    """What one turn decided: setpoints for the driver, and the plan that they are part of, if any."""

    setpoints: Setpoints | None = None
    plan: ControlPlan | None = None


class PackGoal:
    """Carries a session from turn to turn; `FillGoal` has the same methods for a whole list.

    Args:
        session: the goal.
        placements: asks the planner for its placements.
    """

    def __init__(self, session: PackingSession, placements: PlacementClient) -> None:
        self.session, self._placements = session, placements

    @property
    def is_ended(self) -> bool:
        """Whether the goal has its outcome."""
        return self.session.task.outcome is not None

    def turn(self, seen: PackingObservation, _: Array, latency: float) -> GoalTurn:
        """Plan once from the newest observation, for a plan that is in force after `latency` [s]."""
        self._placements.serve(self.session, seen)
        plan = self.session.step(seen, latency)
        return GoalTurn() if plan is None else GoalTurn(plan.setpoints, plan)

    def finish(self, reason: PackingExitReason, time: float, message: str) -> None:
        """End the goal at `time` [s]; the first reason stands."""
        self.session.task.finish(reason, time, message)

    def expire(self, time: float) -> None:
        """End the goal if its time is up."""
        self.session.task.expire(time)

    def feedback(self, seen: PackingObservation, plan: ControlPlan | None) -> PackObject.Feedback:
        """Where the goal stands, after a turn with a plan."""
        assert plan is not None
        return to_feedback(self.session, seen, plan)


def method_of(request: PackObject.Goal) -> PackingMethod:
    """The method that a goal asks for; raises ConfigError if there is none of that name."""
    return PackingMethod.of(request.method) if request.method else PackingMethod.PACK_IT_IN


def refusal_of(request: PackObject.Goal) -> str:
    """Why a goal cannot be taken whatever the cell's state, in words; empty if it can.

    Raises:
        ConfigError: there is no such method.
    """
    method_of(request)
    if not 0.0 <= request.timeout < math.inf:
        return f"timeout {request.timeout}; allowed: seconds from 0 on; 0: the parameter task.timeout"
    return ""
