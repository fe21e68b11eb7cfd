"""A fill job in the running cell: its requests go to the other nodes, its packing goals to a session."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.action import FillContainer

from pack_core.errors import PackError
from pack_core.joints import hold
from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import Fill
from pack_core.packing.goals import FillMethod, PackingExitReason, PackingMethod
from pack_core.packing.packing_list import PackingList
from pack_core.packing.scene import Scene
from pack_core.rotations import Array
from pack_mpc.controller import ControlPlan
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_mpc.filling.fill_job import FillJob
from pack_mpc.filling.requests import FillRequest, Pack, Packed
from pack_mpc.filling.steps import FillObservation
from pack_mpc.observation import PackingObservation
from pack_mpc.ros.fill_clients import FillClients
from pack_mpc.ros.fill_requests import FillRequests, Poll
from pack_mpc.ros.pack_goal import GoalTurn, PlacementClient
from pack_mpc.session import PackingSession
from pack_mpc.task.force_record import ForceRecord

STEP = 0.02
"""Time between two steps of the job while no packing goal is in progress [s]."""
DONE = "done"
"""Exit reason of a job that came to the end of its list."""


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
        self, clients: FillClients, placements: PlacementClient, cell: PackingCell, config: FillSessionConfig,
        given: PackingList, method: FillMethod, seed: int, scene: Callable[[], Scene], time: float,
    ) -> None:  # fmt: skip
        self._placements, self._cell, self._config = placements, cell, config
        self._method, self._scene = method, scene
        self._requests = FillRequests(clients, given, method, seed, scene)
        self.job = FillJob(given, cell, config.fill, scene())
        self.session: PackingSession | None = None
        self.given = len(given.objects)
        self.start, self._stepped = time, -float("inf")
        self.exit_reason, self.message = "", ""
        self._poll: Poll | None = None
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
        self._requests.seen = seen
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
        try:
            answer = self._take_answer()
        except PackError as error:
            self.finish(PackingExitReason.FAULT, seen.joints.time, str(error))
            return GoalTurn()
        command = self.job.step(FillObservation(seen.joints, seen.scene, force, seen.is_held, answer))
        if command.request is not None:
            self._poll = self._begin(command.request)
        if self.job.is_done:
            self.exit_reason = PackingExitReason.FAULT.value if self.job.fault else DONE
            self.message = self.job.report.message
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
            remaining=len(job.remaining),
        )  # fmt: skip

    def _take_answer(self) -> object | None:
        if self._poll is None:
            return None
        answer = self._poll()
        if answer is not None:
            self._poll = None
        return answer

    def _begin(self, request: FillRequest) -> Poll:
        """Send a request; what is returned gives the answer once there is one."""
        if isinstance(request, Pack):
            return self._pack(request)
        return self._requests.begin(request)

    def _pack(self, request: Pack) -> Poll:
        scene = self._scene().gripped(request.grip)
        self._placements.start(self._requests.next_seed(), self._method.placement_variant, request.X_WN)
        config = self._config.of_goals()
        session = PackingSession(scene, self._cell, config, PackingMethod.PACK_IT_IN, self._stepped)
        self.session = session

        def poll() -> Packed | None:
            tried = session.task.tried
            assert session.task.outcome is not None
            return Packed(session.task.outcome, tried[-1] if tried else None)

        return poll
