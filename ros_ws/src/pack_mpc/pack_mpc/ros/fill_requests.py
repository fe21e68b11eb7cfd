"""Requests of a fill job that other nodes answer: each by the steps that lead to its answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import yaml
from pack_interfaces.srv import GripperCommand, PlanFilling, PlanPlacement, PresentObject
from rclpy.task import Future

from pack_core.errors import MessageError
from pack_core.packing.goals import Arrangement, FillMethod
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingList
from pack_core.packing.scene import Scene
from pack_core.ros.awaited_answer import AwaitedAnswer
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_pose, to_pose
from pack_core.ros.messages.scene import to_scene
from pack_core.ros.node import CellNode
from pack_core.tasks.steps import Steps, wait
from pack_mpc.filling.requests import Arrange, Judge, Present, Presented, UsePump
from pack_mpc.observation import PackingObservation


class FillClients:
    """Clients of the services that a fill job uses."""

    def __init__(self, node: CellNode) -> None:
        self._clients = {
            contract.name: node.create_client(contract.type, contract.name)
            for contract in (
                contracts.PLAN_FILLING, contracts.PRESENT, contracts.PLAN_PLACEMENT,
                contracts.GRIPPER_COMMAND,
            )
        }  # fmt: skip

    def call(self, contract: Contract, request: Any) -> Future:
        """Send a request."""
        return self._clients[contract.name].call_async(request)


def reason_in(response: Any) -> str:
    """Why a request was refused; empty if it was not."""
    return "" if response.success else (response.message or "refused without a reason")


def arrangement_in(response: PlanFilling.Response) -> Arrangement:
    """The arrangement in a response.

    Raises:
        MessageError: the planner refused the request, or a pose cannot be used.
    """
    if not response.success:
        raise MessageError(f"{contracts.PLAN_FILLING.name}: {response.message}")
    if len(response.placed) != len(response.poses) or len(response.refused) != len(response.reasons):
        raise MessageError(f"{contracts.PLAN_FILLING.name}: names and poses, or reasons, differ in number")
    placed = dict(zip(response.placed, map(from_pose, response.poses), strict=True))
    refused = dict(zip(response.refused, response.reasons, strict=True))
    return Arrangement(tuple(response.order), placed, refused)


PATIENCE, ONCE = (20.0, 40.0), (20.0,)
"""How long one request after the other is waited for [s of wall clock]; what moves things is asked once."""
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
        seen: the newest observation; set before the first step, and in every turn.
    """

    seen: PackingObservation

    def __init__(
        self, clients: FillClients, given: PackingList, method: FillMethod, seed: int,
        scene: Callable[[], Scene],
    ) -> None:  # fmt: skip
        self._clients, self._given, self._method = clients, given, method
        self._seed, self._scene = seed, scene

    def next_seed(self) -> int:
        """A seed for the next request; a packing goal counts on from its own for further placements."""
        self._seed += 1
        return self._seed

    def steps(self, request: Arrange | Present | Judge | UsePump) -> Steps[object]:
        """What leads to the answer of a request; raises PackError where it is none that can be used."""
        match request:
            case Arrange():
                return self._arrange(request)
            case Present(item):
                return self._present(item)
            case Judge():
                return self._judge()
            case UsePump(close):
                return self._use_pump(close=close)

    def _time(self) -> float:
        return self.seen.joints.time

    def _call(self, contract: Contract, request: Any, patience: Sequence[float] = PATIENCE) -> Steps[Any]:
        """Send a request, and again where no answer comes; raises PackError where none comes at all."""
        send = partial(self._clients.call, contract, request)
        answer = AwaitedAnswer(send, contract.name, patience, time.monotonic(), None)
        while not answer.future.done():
            answer.check(time.monotonic())
            yield
        return answer.future.result()

    def _arrange(self, request: Arrange) -> Steps[object]:
        remaining = self._given.model_copy(update={"objects": list(request.items)})
        text = yaml.safe_dump(remaining.model_dump(mode="json", exclude_none=True), sort_keys=False)
        planned = request.planned
        response = yield from self._call(
            contracts.PLAN_FILLING,
            PlanFilling.Request(
                scene=to_scene(self.seen.scene), list=text, method=self._method.value, seed=self.next_seed(),
                planned=list(planned), planned_poses=[to_pose(X_WO) for X_WO in planned.values()],
            ),
        )  # fmt: skip
        return arrangement_in(response)

    def _present(self, item: ObjectModel) -> Steps[object]:
        text = yaml.safe_dump(item.model_dump(mode="json", exclude_none=True), sort_keys=False)
        response = yield from self._call(contracts.PRESENT, PresentObject.Request(object=text), ONCE)
        if reason := reason_in(response):
            return Presented(None, reason)

        def is_described() -> bool:
            scene = self._scene()
            return scene.new_object.name == item.name and scene.is_handed_over

        # The description comes by a topic of its own, and maybe later than the answer.
        if not (yield from wait(is_described, ONCE[0], time.monotonic)):
            raise MessageError(
                f"{contracts.DESCRIPTION.name} does not say that '{item.name}' was handed over"
            )
        return Presented(self._scene())

    def look(self) -> Steps[None]:
        """Wait until depth cameras have looked into the container; perception tells nothing before."""
        start = self._time()
        yield from wait(lambda: self._is_seen() and self.seen.scene.time > start, SIGHT_TIME, self._time)

    def _is_seen(self) -> bool:
        """Whether all described objects have been seen."""
        described = self._scene()
        return {*described.names, described.new_object.name} == set(self.seen.scene.objects)

    def _judge(self) -> Steps[object]:
        """Ask once the object has been seen; one that is not will be looked for."""
        if not (yield from wait(self._is_seen, SIGHT_TIME, self._time)):
            return ""
        scene = to_scene(self.seen.scene)
        request = PlanPlacement.Request(scene=scene, variant=JUDGED_BY, seed=self.next_seed())
        return (yield from self._call(contracts.PLAN_PLACEMENT, request)).message

    def _use_pump(self, *, close: bool) -> Steps[object]:
        request = GripperCommand.Request(close=close)
        return reason_in((yield from self._call(contracts.GRIPPER_COMMAND, request, ONCE)))
