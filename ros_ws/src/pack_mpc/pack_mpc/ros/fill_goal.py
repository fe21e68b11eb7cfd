"""A fill job in the running cell: its requests go to the other nodes, its packing goals to a session."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import yaml
from pack_interfaces.srv import GripperCommand, PlanFilling, PlanPlacement, PresentObject
from rclpy.task import Future

from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.packing.arrangement import Arrangement, FillMethod
from pack_core.packing.cell import PackingCell
from pack_core.packing.exit_reason import PackingExitReason
from pack_core.packing.method import PackingMethod
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingList
from pack_core.packing.scene import Scene
from pack_core.ros.cell_node import CellNode
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.conversions import from_pose, to_pose
from pack_core.ros.scene_messages import to_scene
from pack_core.rotations import Array
from pack_mpc.controller import ControlPlan
from pack_mpc.filling.fill_job import FillJob
from pack_mpc.filling.requests import Arrange, FillRequest, Grip, Judge, Pack, Packed, Present, Presented
from pack_mpc.filling.steps import FillObservation
from pack_mpc.force_record import ForceRecord
from pack_mpc.ros.placement_client import PlacementClient
from pack_mpc.session import PackingObservation, PackingSession, SessionConfig, hold

STEP = 0.02
"""Time between two steps of the job while no packing goal is in progress [s]."""
JUDGED_BY = "algorithm_1"
"""Variant of the placement planner that says whether an object fits at all: it rehearses nothing."""


@dataclass(frozen=True)
class FillTurn:
    """What one turn of the job decided: setpoints for the driver, and the plan that they are part of."""

    setpoints: Setpoints | None = None
    plan: ControlPlan | None = None


class FillClients:
    """The services that a fill job uses."""

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


class FillGoal:
    """Runs a `FillJob`, turn by turn, in the thread of the node's worker.

    Args:
        clients: the services.
        placements: asks for placements of a packing goal.
        cell: the cell's physical facts.
        config: parameters of the job and its packing goals.
        given: the list.
        method: how places are chosen.
        seed: of arrangements and placements.
        scene: returns the newest description of the cell.
        time: now [s].
    """

    def __init__(
        self, clients: FillClients, placements: PlacementClient, cell: PackingCell, config: SessionConfig,
        given: PackingList, method: FillMethod, seed: int, scene: Callable[[], Scene], time: float,
    ) -> None:  # fmt: skip
        self._clients, self._placements, self._cell, self._config = clients, placements, cell, config
        self._given, self._method, self._seed, self._scene = given, method, seed, scene
        self.job = FillJob(given, cell, config.fill, scene())
        self.session: PackingSession | None = None
        self.given = len(given.objects)
        self.start, self._stepped = time, -float("inf")
        self._poll: Callable[[], object | None] | None = None
        self._seen: PackingObservation | None = None
        self._forces, self.force_peak = ForceRecord(), 0.0

    def turn(self, seen: PackingObservation, force: Array, latency: float) -> FillTurn:
        """Go on with the newest observation.

        Args:
            seen: the newest observation.
            force: newest external force on cup or held object `(3,)` [N].
            latency: time until a plan will be in force [s].
        """
        self._seen = seen
        self.force_peak = max(self.force_peak, self._forces.note(seen.forces))
        session = self.session
        if session is not None:
            self._placements.serve(session, seen)
            plan = session.step(seen, latency)
            if session.task.outcome is None:
                return FillTurn() if plan is None else FillTurn(plan.setpoints, plan)
            self.session = None
            return FillTurn(hold(seen.joints))
        if seen.joints.time - self._stepped < STEP:
            return FillTurn()
        self._stepped = seen.joints.time
        answer = self._take_answer()
        command = self.job.step(FillObservation(seen.joints, seen.scene, force, seen.is_held, answer))
        if command.request is not None:
            self._poll = self._begin(command.request)
        return FillTurn(command.setpoints)

    def cancel(self, reason: PackingExitReason, time: float, message: str) -> None:
        """End a packing goal in progress; the job itself is simply not continued."""
        if self.session is not None:
            self.session.task.finish(reason, time, message)

    def _take_answer(self) -> object | None:
        if self._poll is None:
            return None
        answer = self._poll()
        if answer is not None:
            self._poll = None
        return answer

    def _begin(self, request: FillRequest) -> Callable[[], object | None]:
        """Send a request; what is returned gives the answer once there is one."""
        match request:
            case Arrange():
                return self._arrange(request)
            case Present(item):
                return self._present(item)
            case Judge():
                return self._judge()
            case Grip(close):
                future = self._call(contracts.GRIPPER_COMMAND, GripperCommand.Request(close=close))
                return lambda: _reason(future.result()) if future.done() else None
            case Pack():
                return self._pack(request)

    def _call(self, contract: Contract, request: Any) -> Future:
        return self._clients.call(contract, request)

    def _arrange(self, request: Arrange) -> Callable[[], object | None]:
        assert self._seen is not None
        remaining = self._given.model_copy(update={"objects": list(request.items)})
        text = yaml.safe_dump(remaining.model_dump(mode="json", exclude_none=True), sort_keys=False)
        planned = request.planned
        self._seed += 1
        future = self._call(
            contracts.PLAN_FILLING,
            PlanFilling.Request(
                scene=to_scene(self._seen.scene), list=text, method=self._method.value, seed=self._seed,
                planned=list(planned), planned_poses=[to_pose(X_WO) for X_WO in planned.values()],
            ),
        )  # fmt: skip
        return lambda: _arrangement(future.result()) if future.done() else None

    def _present(self, item: ObjectModel) -> Callable[[], object | None]:
        text = yaml.safe_dump(item.model_dump(mode="json", exclude_none=True), sort_keys=False)
        future = self._call(contracts.PRESENT, PresentObject.Request(object=text))

        def poll() -> Presented | None:
            if not future.done():
                return None
            if reason := _reason(future.result()):
                return Presented(None, reason)
            # the description comes by a topic of its own, and maybe later than the answer
            scene = self._scene()
            is_new = scene.new_object.name == item.name and scene.is_handed_over
            return Presented(scene) if is_new else None

        return poll

    def _judge(self) -> Callable[[], object | None]:
        """Ask once the object has been seen; one that is not will be looked for."""
        assert self._seen is not None
        deadline, future = self._seen.joints.time + 1.0, None

        def poll() -> str | None:
            nonlocal future
            assert self._seen is not None
            if future is not None:
                return future.result().message if future.done() else None
            scene, names = self._seen.scene, {*self._scene().names, self._scene().new_object.name}
            if names == set(scene.objects):
                request = PlanPlacement.Request(scene=to_scene(scene), variant=JUDGED_BY, seed=self._seed)
                future = self._call(contracts.PLAN_PLACEMENT, request)
            return "" if future is None and self._seen.joints.time > deadline else None

        return poll

    def _pack(self, request: Pack) -> Callable[[], object | None]:
        assert self._seen is not None
        scene, now = self._scene().gripped(request.grip), self._seen.joints.time
        self._seed += 1
        self._placements.start(self._seed, self._method.placement_variant, request.X_WN)
        session = PackingSession(scene, self._cell, self._config, PackingMethod.PACK_IT_IN, now)
        self.session = session

        def poll() -> Packed | None:
            tried = session.task.tried
            assert session.task.outcome is not None
            return Packed(session.task.outcome, tried[-1] if tried else None)

        return poll


def _reason(response: Any) -> str:
    """Why a request was refused; empty if it was not."""
    return "" if response.success else (response.message or "refused without a reason")


def _arrangement(response: PlanFilling.Response) -> Arrangement:
    """The arrangement in a response.

    Raises:
        MessageError: the planner refused the request, or a pose cannot be used.
    """
    if not response.success:
        raise MessageError(f"{contracts.PLAN_FILLING.name}: {response.message}")
    placed = dict(zip(response.placed, map(from_pose, response.poses), strict=True))
    refused = dict(zip(response.refused, response.reasons, strict=True))
    return Arrangement(tuple(response.order), placed, refused)
