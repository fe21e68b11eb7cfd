"""The action /fill_container: a job in the running cell, and what is told of it.

The requests of a job go to the other nodes, its packing goals to a session.
"""

from __future__ import annotations

import json
from collections.abc import Callable

from pack_interfaces.action import FillContainer
from std_msgs.msg import String

from pack_core.joints import hold
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.free_space import Fill
from pack_core.packing.goals import FillMethod, PackingExitReason, PackingMethod
from pack_core.packing.packing_list import PackingList, parse_list
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.node import CellNode
from pack_core.rotations import Array
from pack_core.tasks.steps import Steps, TaskRun
from pack_mpc.controller import ControlPlan
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_mpc.filling.fill_job import FillJob
from pack_mpc.filling.requests import FillObservation, FillRequest, Pack, Packed
from pack_mpc.observation import PackingObservation
from pack_mpc.ros.fill_requests import FillClients, FillRequests
from pack_mpc.ros.mailbox import Mailbox
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
        self._pending: TaskRun[object] | None = None
        self._forces, self.force_peak = ForceRecord(), 0.0

    def follow(self, scene: Scene) -> None:
        """Take up the newest description in the packing goal that is in progress."""
        if self.session is not None:
            self.session.follow(scene)

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
        answer = self._take_answer()
        if self.is_ended:
            return GoalTurn()
        command = self.job.step(FillObservation(seen.joints, seen.scene, force, seen.is_held, answer))
        if command.request is not None:
            self._pending = TaskRun(self._steps(command.request))
            self._pending.go_on()
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
        """The answer to the last request, once; ends the job where it is none that can be used."""
        run = self._pending
        if run is None:
            return None
        run.go_on()
        if not run.is_over:
            return None
        self._pending = None
        if run.failure:
            self.finish(PackingExitReason.FAULT, self._stepped, run.failure)
        return run.outcome

    def _steps(self, request: FillRequest) -> Steps[object]:
        """What leads to the answer of a request."""
        return self._pack(request) if isinstance(request, Pack) else self._requests.steps(request)

    def _pack(self, request: Pack) -> Steps[Packed]:
        """Run a packing goal, of which every turn is made, to its outcome."""
        if self._cell.perception is Perception.DEPTH:
            yield from self._requests.look()
        self.job.follow(self._scene())
        scene = self.job.scene.gripped(request.grip)
        self._placements.start(self._requests.next_seed(), self._method.placement_variant, request.X_WN)
        config = self._config.of_goals()
        session = PackingSession(scene, self._cell, config, PackingMethod.PACK_IT_IN, self._stepped)
        self.session = session
        while session.task.outcome is None:
            yield
        tried = session.task.tried
        return Packed(session.task.outcome, tried[-1] if tried else None)


def to_fill_result(goal: FillGoal, time: float) -> FillContainer.Result:
    """The result of a job that has ended at `time` [s]."""
    report, fill = goal.job.report, _fill(goal)
    given, packed = goal.given, len(report.packed)
    return FillContainer.Result(
        success=packed == given, exit_reason=goal.exit_reason, message=goal.message, packed=packed,
        given=given,
        base_area=fill.base_area, volume=fill.volume, execution_time=time - goal.start,
        report=to_fill_report(goal),
    )  # fmt: skip


def to_fill_report(goal: FillGoal) -> str:
    """Each object's fate, and the fill over time, as JSON; times in [s], shares from 0 to 1."""
    return json.dumps(
        {
            "exit_reason": goal.exit_reason, "message": goal.message, "start": goal.start,
            "force_peak": goal.force_peak, **_so_far(goal),
        }
    )  # fmt: skip


def to_fill_progress(goal: FillGoal, time: float) -> str:
    """Where a job stands at `time` [s], as JSON: what `to_fill_report` has, and what is still to come."""
    job = goal.job
    return json.dumps(
        {
            "time": time, "start": goal.start, "stage": job.stage.value, "object": job.current,
            "to_come": job.remaining, **_so_far(goal),
        }
    )  # fmt: skip


def _so_far(goal: FillGoal) -> dict[str, object]:
    """Fates of the objects that were handled, and the fill after each."""
    report = goal.job.report
    return {
        "objects": [row.row() for row in report.objects],
        "fills": [[time, fill.base_area, fill.volume] for time, fill in report.fills],
    }


def _fill(goal: FillGoal) -> Fill:
    fills = goal.job.report.fills
    return fills[-1][1] if fills else Fill(0.0, 0.0)


class FillAction:
    """Begins fill jobs and tells what became of them.

    Args:
        node: that takes the goals.
        placements: asks the planner for placements.
        cell: the cell's physical facts.
    """

    def __init__(self, node: CellNode, placements: PlacementClient, cell: PackingCell) -> None:
        self._placements, self._cell = placements, cell
        self._clients = FillClients(node)
        self._result = node.advertise(contracts.FILL_RESULT)
        self._progress = node.advertise(contracts.FILL_PROGRESS)
        self._published: object = None

    def refusal(self, request: FillContainer.Goal, scene: Scene | None, mailbox: Mailbox) -> str:
        """Why a job cannot begin, in words; empty if it can.

        Raises:
            PackError: the list or the method cannot be used.
        """
        FillMethod.of(request.method)
        given = parse_list(request.list, "goal", self._cell)
        if scene is None or mailbox.joints is None:
            return f"no {contracts.DESCRIPTION.name} or {contracts.JOINT_STATES.name} yet: is sim up?"
        if there := sorted({item.name for item in given.objects} & set(scene.names)):
            return f"the list has {', '.join(there)}, which the container has already; allowed: other names"
        held = scene.new_object.name
        return f"the pump holds '{held}'; allowed: an empty cup" if mailbox.is_held else ""

    def begin(
        self, request: FillContainer.Goal, config: FillSessionConfig, scene: Callable[[], Scene], time: float
    ) -> FillGoal:
        """The job of an accepted goal; `scene` returns the newest description of the cell."""
        given, method = parse_list(request.list, "goal", self._cell), FillMethod.of(request.method)
        self._published = None
        return FillGoal(
            self._clients, self._placements, self._cell, config, given, method, request.seed, scene, time
        )

    def publish_progress(self, goal: FillGoal, time: float) -> None:
        """Publish where a job stands at `time` [s], if that has changed."""
        job = goal.job
        now = (job.stage, job.current, len(job.report.objects), len(job.report.fills))
        if now != self._published:
            self._published = now
            self._progress.publish(String(data=to_fill_progress(goal, time)))

    def publish_result(self, goal: FillGoal) -> None:
        """Publish what became of a job that has ended."""
        self._result.publish(String(data=to_fill_report(goal)))
