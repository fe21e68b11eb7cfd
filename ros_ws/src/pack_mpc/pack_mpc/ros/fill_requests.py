"""Requests of a fill job that other nodes answer; each is looked at again until there is an answer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import yaml
from pack_interfaces.srv import GripperCommand, PlanFilling, PlanPlacement, PresentObject
from rclpy.task import Future

from pack_core.packing.goals import FillMethod
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingList
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import to_pose
from pack_core.ros.messages.scene import to_scene
from pack_mpc.filling.requests import Arrange, Judge, Present, Presented, UsePump
from pack_mpc.observation import PackingObservation
from pack_mpc.ros.fill_clients import FillClients, arrangement_in, reason_in

Poll = Callable[[], object | None]
"""Returns the answer to a request, once there is one."""
JUDGED_BY = "algorithm_1"
"""Variant of the placement planner that says whether an object fits at all: it rehearses nothing."""
SIGHT_TIME = 1.0
"""Longest wait until an object that is to be judged has been seen [s]."""


class FillRequests:
    """Sends the requests of one job.

    Args:
        clients: the services.
        given: the job's list.
        method: how places are chosen.
        seed: of the first arrangement; each further request that needs one has the next.
        scene: returns the newest description of the cell.

    Attributes:
        seen: the newest observation; set before `begin`, and in every turn.
    """

    seen: PackingObservation

    def __init__(
        self, clients: FillClients, given: PackingList, method: FillMethod, seed: int,
        scene: Callable[[], Scene],
    ) -> None:  # fmt: skip
        self._clients, self._given, self._method = clients, given, method
        self._seed, self._scene = seed, scene

    def next_seed(self) -> int:
        """A seed that no other request of the job has."""
        self._seed += 1
        return self._seed

    def begin(self, request: Arrange | Present | Judge | UsePump) -> Poll:
        """Send a request; what is returned gives the answer once there is one."""
        match request:
            case Arrange():
                return self._arrange(request)
            case Present(item):
                return self._present(item)
            case Judge():
                return self._judge()
            case UsePump(close):
                future = self._call(contracts.GRIPPER_COMMAND, GripperCommand.Request(close=close))
                return lambda: reason_in(future.result()) if future.done() else None

    def _call(self, contract: Contract, request: Any) -> Future:
        return self._clients.call(contract, request)

    def _arrange(self, request: Arrange) -> Poll:
        remaining = self._given.model_copy(update={"objects": list(request.items)})
        text = yaml.safe_dump(remaining.model_dump(mode="json", exclude_none=True), sort_keys=False)
        planned = request.planned
        future = self._call(
            contracts.PLAN_FILLING,
            PlanFilling.Request(
                scene=to_scene(self.seen.scene), list=text, method=self._method.value, seed=self.next_seed(),
                planned=list(planned), planned_poses=[to_pose(X_WO) for X_WO in planned.values()],
            ),
        )  # fmt: skip
        return lambda: arrangement_in(future.result()) if future.done() else None

    def _present(self, item: ObjectModel) -> Poll:
        text = yaml.safe_dump(item.model_dump(mode="json", exclude_none=True), sort_keys=False)
        future = self._call(contracts.PRESENT, PresentObject.Request(object=text))

        def poll() -> Presented | None:
            if not future.done():
                return None
            if reason := reason_in(future.result()):
                return Presented(None, reason)
            # the description comes by a topic of its own, and maybe later than the answer
            scene = self._scene()
            is_new = scene.new_object.name == item.name and scene.is_handed_over
            return Presented(scene) if is_new else None

        return poll

    def _judge(self) -> Poll:
        """Ask once the object has been seen; one that is not will be looked for."""
        deadline = self.seen.joints.time + SIGHT_TIME
        future: Future | None = None

        def poll() -> str | None:
            nonlocal future
            if future is not None:
                return future.result().message if future.done() else None
            scene, described = self.seen.scene, self._scene()
            if {*described.names, described.new_object.name} == set(scene.objects):
                request = PlanPlacement.Request(
                    scene=to_scene(scene), variant=JUDGED_BY, seed=self.next_seed()
                )
                future = self._call(contracts.PLAN_PLACEMENT, request)
            return "" if future is None and self.seen.joints.time > deadline else None

        return poll
