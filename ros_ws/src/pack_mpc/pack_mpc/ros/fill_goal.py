"""A fill job in the running cell: its requests go to the other nodes, its packing goals to a session."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import yaml
from pack_interfaces.action import FillContainer
from pack_interfaces.srv import GripperCommand, PlanFilling, PlanPlacement, PresentObject
from rclpy.task import Future

from pack_core.packing.arrangement import FillMethod
from pack_core.packing.cell import PackingCell
from pack_core.packing.exit_reason import PackingExitReason
from pack_core.packing.method import PackingMethod
from pack_core.packing.objects import ObjectModel
from pack_core.packing.packing_list import PackingList
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.conversions import to_pose
from pack_core.ros.scene_messages import to_scene
from pack_core.rotations import Array
from pack_mpc.controller import ControlPlan
from pack_mpc.filling.fill_job import FillJob
from pack_mpc.filling.fill_report import Fill
from pack_mpc.filling.requests import Arrange, FillRequest, Grip, Judge, Pack, Packed, Present, Presented
from pack_mpc.filling.steps import FillObservation
from pack_mpc.force_record import ForceRecord
from pack_mpc.ros.fill_clients import FillClients, arrangement_in, reason_in
from pack_mpc.ros.pack_goal import GoalTurn
from pack_mpc.ros.placement_client import PlacementClient
from pack_mpc.session import PackingObservation, PackingSession, SessionConfig, hold

STEP = 0.02
"""Time between two steps of the job while no packing goal is in progress [s]."""
DONE = "done"
"""Exit reason of a job that came to the end of its list."""
JUDGED_BY = "algorithm_1"
"""Variant of the placement planner that says whether an object fits at all: it rehearses nothing."""


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
        self.exit_reason, self.message = "", ""
        self._poll: Callable[[], object | None] | None = None
        self._seen: PackingObservation | None = None
        self._forces, self.force_peak = ForceRecord(), 0.0

    def turn(self, seen: PackingObservation, force: Array, latency: float) -> GoalTurn:
        """Go on with the newest observation.

        Args:
            seen: the newest observation.
            force: newest external force on cup or held object `(3,)` [N].
            latency: time until a plan will be in force [s].
        """
        if self.is_ended:
            return GoalTurn()
        self._seen = seen
        self.force_peak = max(self.force_peak, self._forces.note(seen.forces))
        session = self.session
        if session is not None:
            self._placements.serve(session, seen)
            plan = session.step(seen, latency)
            if session.task.outcome is None:
                return GoalTurn() if plan is None else GoalTurn(plan.setpoints, plan)
            self.session = None
            return GoalTurn(hold(seen.joints))
        if seen.joints.time - self._stepped < STEP:
            return GoalTurn()
        self._stepped = seen.joints.time
        answer = self._take_answer()
        command = self.job.step(FillObservation(seen.joints, seen.scene, force, seen.is_held, answer))
        if command.request is not None:
            self._poll = self._begin(command.request)
        if self.job.is_done:
            self.exit_reason, self.message = DONE, self.job.report.message
        return GoalTurn(command.setpoints)

    @property
    def is_ended(self) -> bool:
        """Whether the job is done, or was ended."""
        return bool(self.exit_reason)

    def finish(self, reason: PackingExitReason, time: float, message: str) -> None:
        """End the job at `time` [s]; the first reason stands."""
        if not self.exit_reason:
            self.exit_reason, self.message = reason.value, message
            if self.session is not None:
                self.session.task.finish(reason, time, message)

    def expire(self, time: float) -> None:
        """End the packing goal in progress if its time is up; the job as a whole has no end of its own."""
        if self.session is not None:
            self.session.task.expire(time)

    def feedback(self, seen: PackingObservation, _: ControlPlan | None) -> FillContainer.Feedback:
        """Where the job stands."""
        job, machine = self.job, None if self.session is None else self.session.task.machine
        fill = job.report.fills[-1][1] if job.report.fills else Fill(0.0, 0.0)
        stage = job.stage.value if machine is None else f"{job.stage.value} {machine.stage.value}"
        return FillContainer.Feedback(
            object=job.current, stage=stage, elapsed=seen.joints.time - self.start,
            base_area=fill.base_area, volume=fill.volume, packed=len(job.report.packed),
            remaining=job.remaining,
        )  # fmt: skip

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
                return lambda: reason_in(future.result()) if future.done() else None
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
        return lambda: arrangement_in(future.result()) if future.done() else None

    def _present(self, item: ObjectModel) -> Callable[[], object | None]:
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
