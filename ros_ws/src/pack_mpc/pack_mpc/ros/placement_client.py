"""Asks the placement planner for a placement when the task needs one, without waiting for the answer."""

from __future__ import annotations

from pack_interfaces.srv import PlanPlacement
from rclpy.task import Future

from pack_core.errors import MessageError
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.messages.conversions import from_pose, to_point, to_pose
from pack_core.ros.messages.packing import from_way
from pack_core.ros.messages.scene import to_scene
from pack_core.ros.node import CellNode
from pack_core.rotations import Pose
from pack_mpc.session import PackingObservation, PackingSession


class PlacementClient:
    """Has one request pending at a time; the worker takes up the answer in its next iteration."""

    def __init__(self, node: CellNode) -> None:
        contract = contracts.PLAN_PLACEMENT
        self._client = node.create_client(contract.type, contract.name)
        self._pending: Future | None = None
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
        return self._pending is not None and not self._pending.done()

    def serve(self, session: PackingSession, seen: PackingObservation) -> None:
        """Hand over the answer if there is one, or send a request if a placement is needed."""
        if self._pending is not None:
            if self._pending.done():
                response, self._pending = self._pending.result(), None
                self._hand_over(session, seen, response)
        elif session.needs_placement(seen.scene) and self._client.service_is_ready():
            self._pending = self._client.call_async(self._request(session, seen))

    def _request(self, session: PackingSession, seen: PackingObservation) -> PlanPlacement.Request:
        task = session.task
        return PlanPlacement.Request(
            scene=to_scene(seen.scene), lean=task.lean,
            variant=self._variant or session.method.placement_variant,
            seed=self._seed + len(task.tried),
            avoid=[to_point(p) for p in task.avoid], avoid_radius=task.avoid_radius,
            near=[] if self._near is None else [to_pose(self._near)],
        )  # fmt: skip

    def _hand_over(
        self, session: PackingSession, seen: PackingObservation, response: PlanPlacement.Response
    ) -> None:
        task, time = session.task, seen.joints.time
        if response.status != PlanPlacement.Response.SUCCESS:
            task.refuse(time, response.message)
            return
        try:
            X_WN, way = from_pose(response.pose), from_way(response)
        except MessageError as error:
            task.refuse(time, str(error))
            return
        task.place(X_WN, tuple(response.collisions), way, seen.scene, response.is_rehearsed)
