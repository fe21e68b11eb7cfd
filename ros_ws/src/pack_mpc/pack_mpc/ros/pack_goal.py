"""A packing goal in the running cell: its session, with placements from the planner."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import partial

from pack_interfaces.action import PackObject
from pack_interfaces.srv import PlanPlacement

from pack_core.errors import MessageError, PackError
from pack_core.joints import Setpoints
from pack_core.packing.goals import PackingExitReason, PackingMethod
from pack_core.packing.scene import Scene
from pack_core.ros.awaited_answer import PATIENCE, AwaitedAnswer
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_pose, to_point, to_pose
from pack_core.ros.messages.packing import from_way
from pack_core.ros.messages.scene import to_scene
from pack_core.ros.node import CellNode
from pack_core.rotations import Array, Pose
from pack_mpc.controller import ControlPlan
from pack_mpc.observation import PackingObservation
from pack_mpc.ros.status import to_feedback
from pack_mpc.session import PackingSession

REHEARSED = ("", "physics")
"""Planners that rehearse entries: empty is the configured one, as for PackItIn."""
UNREHEARSED = "algorithm_1"
"""What they do, but for the rehearsals."""


class PlacementClient:
    """Has one request pending at a time; the worker takes up the answer in its next iteration.

    Attributes:
        is_sparing: whether no entries shall be rehearsed, as the machine is busy.
    """

    is_sparing = False

    def __init__(self, node: CellNode) -> None:
        contract = contracts.PLAN_PLACEMENT
        self._client, self._log = node.create_client(contract.type, contract.name), node.get_logger()
        self._pending: AwaitedAnswer | None = None
        self.start(0)

    def start(self, seed: int, variant: str = "", near: Pose | None = None) -> None:
        """Begin a goal.

        Args:
            seed: decides the random samples of its placements.
            variant: planner that chooses them; empty: that of the goal's method.
            near: where the first one is sought, X_WN; None: anywhere.
        """
        self._pending, self._seed = None, seed
        self._variant, self._near = variant, near

    @property
    def is_pending(self) -> bool:
        """Whether the planner has been asked and has not answered yet."""
        return self._pending is not None and not self._pending.future.done()

    def serve(self, session: PackingSession, seen: PackingObservation) -> None:
        """Hand over the answer if there is one, or send a request if a placement is needed."""
        pending = self._pending
        if pending is not None:
            pending.check(time.monotonic())
            if pending.future.done():
                self._pending = None
                self._take(session, seen, pending)
        elif session.needs_placement(seen.scene):
            if not self._client.service_is_ready():
                self._log.warning(f"nobody serves {self._client.srv_name}", throttle_duration_sec=2.0)
                return
            send = partial(self._client.call_async, self._request(session, seen))
            self._pending = AwaitedAnswer(send, self._client.srv_name, PATIENCE, time.monotonic(), None)

    def _request(self, session: PackingSession, seen: PackingObservation) -> PlanPlacement.Request:
        task = session.task
        return PlanPlacement.Request(
            scene=to_scene(seen.scene), lean=task.lean,
            variant=self._affordable(self._variant or session.method.placement_variant),
            seed=self._seed + task.answers,
            avoid=[to_point(p) for p in task.avoid], avoid_radius=task.avoid_radius,
            near=[] if self._near is None else [to_pose(self._near)],
        )  # fmt: skip

    def _affordable(self, variant: str) -> str:
        """The planner to ask for when this one is wanted."""
        return UNREHEARSED if self.is_sparing and variant in REHEARSED else variant

    def _take(self, session: PackingSession, seen: PackingObservation, answer: AwaitedAnswer) -> None:
        try:
            response = answer.future.result()
        except PackError as error:
            session.task.refuse(seen.joints.time, str(error))
        else:
            self._hand_over(session, seen, response)

    def _hand_over(
        self, session: PackingSession, seen: PackingObservation, response: PlanPlacement.Response
    ) -> None:
        task, now = session.task, seen.joints.time
        if response.status != PlanPlacement.Response.SUCCESS:
            task.refuse(now, response.message)
            return
        try:
            X_WN, way = from_pose(response.pose), from_way(response)
        except MessageError as error:
            task.refuse(now, str(error))
            return
        task.place(X_WN, tuple(response.collisions), way, seen.scene, response.is_rehearsed)


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

    def follow(self, scene: Scene) -> None:
        """Take up the newest description."""
        self.session.follow(scene)

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
