"""The controller as a ROS 2 node: actions `/pack_object` and `/fill_container` in, joint setpoints out."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from pack_interfaces.action import FillContainer, PackObject
from pydantic import Field, PositiveFloat
from std_msgs.msg import String

from pack_core.errors import PackError
from pack_core.joints import Setpoints, hold
from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import PackingExitReason
from pack_core.packing.load_shedding import GivenUp, LoadShedding
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.goal_node import GoalNode
from pack_core.ros.messages.serialized_setpoints import TrajectoryWriter
from pack_core.ros.packing import read_packing_cell
from pack_core.ros.run import run_node
from pack_mpc.cost.weights import load_weights
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_mpc.held_watch import arm_chain
from pack_mpc.optimizers import OPTIMIZERS
from pack_mpc.ros.fill_goal import FillAction, FillGoal, to_fill_result
from pack_mpc.ros.mailbox import Mailbox
from pack_mpc.ros.pack_goal import PackGoal, PlacementClient, method_of, refusal_of
from pack_mpc.ros.status import to_outcome, to_result, to_status
from pack_mpc.session import PackingSession
from pack_mpc.worker import Worker, WorkerConfig


class MpcNodeConfig(FillSessionConfig):
    """Parameters of the node `mpc`."""

    worker: WorkerConfig = WorkerConfig()
    watched: tuple[str, ...] = Field(
        default=("sim", "perception", "planner", "recorder"), description="the arm holds while one is silent"
    )
    fault_time: PositiveFloat = Field(default=1.0, description="silence that ends a goal [s of wall clock]")


class MpcNode(GoalNode):
    """Packs the held object, or the objects of a list: plans in a worker thread, as fast as it can."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("mpc", **kwargs)
        self._change(self.read_parameters(MpcNodeConfig, self._change))
        self._cell = read_packing_cell(self)
        load_kinematics(self._cell)
        self._scene: Scene | None = None
        self._load = LoadShedding()
        self._pursued: PackGoal | FillGoal | None = None
        self._sending = threading.Lock()
        self._mailbox = Mailbox(self, self._cell.robot.arm.joints)
        self._placements = PlacementClient(self)
        self._fills = FillAction(self, self._placements, self._cell)
        self._setpoints = self.advertise(contracts.SETPOINTS)
        self._writer = TrajectoryWriter(self._cell.robot.arm.joints)
        self._status = self.advertise(contracts.MPC_STATUS)
        self._result = self.advertise(contracts.RESULT)
        self.listen(contracts.DESCRIPTION, self._on_description)
        self._worker = Worker(self._iterate, self._config.worker, self._on_error)
        self.take_goals(
            contracts.PACK_OBJECT, self._config.watched, self._config.fault_time, contracts.FILL_CONTAINER
        )

    def _change(self, config: MpcNodeConfig) -> None:
        """Use these parameters from the next goal on."""
        load_weights(config.weights)  # what there is not is found now, not at the next goal
        OPTIMIZERS[config.controller.optimizer].require()
        self._config = config

    @property
    def waits_for(self) -> str:
        if self._scene is None:
            return f"no {contracts.DESCRIPTION.name} yet: is sim up?"
        return self._mailbox.missing(self._scene)

    def destroy_node(self) -> None:
        """Stop the worker before the node that it publishes with."""
        self._worker.stop()
        super().destroy_node()

    def _on_description(self, message: String) -> None:
        self._scene = Scene.from_yaml(message.data, contracts.DESCRIPTION.name)

    def refusal(self, request: PackObject.Goal | FillContainer.Goal) -> str:
        if isinstance(request, FillContainer.Goal):
            return self._fills.refusal(request, self._scene, self._mailbox)
        return self.waits_for or refusal_of(request)

    async def pursue(self, request: PackObject.Goal | FillContainer.Goal) -> Any:
        """Hand the goal to the worker and wait for its outcome."""
        self._mailbox.clear_forces()
        self._load = LoadShedding()
        if isinstance(request, FillContainer.Goal):
            fill = self._fills.begin(request, self._config, self._described, self._mailbox.time)
            await self._reach_end(fill, lambda: self._fills.publish_result(fill))
            return to_fill_result(fill, self._mailbox.time)
        method, now = method_of(request), self._mailbox.time
        session = PackingSession(self._described(), self._cell, self._config, method, now, request.timeout)
        self._placements.start(request.seed)
        goal = PackGoal(session, self._placements)
        await self._reach_end(goal, lambda: self._result.publish(to_outcome(session)))
        return to_result(session)

    async def _reach_end(self, goal: PackGoal | FillGoal, publish: Callable[[], None]) -> None:
        """Have a goal pursued, and its end published, also where that is a failure."""
        self._pursued = goal
        self._worker.wake()
        try:
            await self.until_goal_ends()
        except PackError:  # not in `finally`, which runs, too, when the node is gone before its goal
            publish()
            raise
        publish()

    def _described(self) -> Scene:
        assert self._scene is not None
        return self._scene

    def describe(self, result: PackObject.Result) -> str:
        return f"{result.exit_reason}, {result.message}"

    def _iterate(self, latency: float) -> float | None:
        """Plan once from the newest messages, in the worker's thread; the latency is returned [s]."""
        goal = self._pursued
        if goal is None:
            return None
        self._worker.wake()  # again after this turn, until the goal has ended
        if self.is_cancel_requested:
            goal.finish(PackingExitReason.CANCELED, self._mailbox.time, "on request")
            self._end(goal)
            return None
        if not self._mailbox.wait_for_joints() or self.silent_peers:
            self._expire(goal)
            return None
        session = goal.session
        try:
            seen = self._mailbox.observe(self._config.blind_time if session is None else session.blind_time)
            goal.follow(self._described())
            self._give_up_for_load(goal)
            turn = goal.turn(seen, self._mailbox.force, latency)
        except PackError:
            self._expire(goal)
            raise
        self._worker.is_waiting = self._placements.is_pending
        if isinstance(goal, FillGoal):
            self._fills.publish_progress(goal, seen.joints.time)
        if goal.is_ended:
            self._end(goal)
            return None
        if turn.setpoints is None or not self._send(goal, turn.setpoints):
            return None
        self.failures.passed("iteration")
        self.publish_feedback(goal.feedback(seen, turn.plan))
        if turn.plan is None or goal.session is None:
            return None
        self._load = self._load.after(seen.joints.time)
        self._status.publish(to_status(goal.session, seen, turn.plan, self._load))
        return self._mailbox.time - seen.joints.time

    def _give_up_for_load(self, goal: PackGoal | FillGoal) -> None:
        """Do without what does not fit."""
        self._placements.is_sparing = self._load.gives_up(GivenUp.REHEARSALS)
        if goal.session is not None:
            goal.session.controller.spare(self._load.gives_up(GivenUp.ROLLOUTS))

    def _send(self, goal: PackGoal | FillGoal, setpoints: Setpoints) -> bool:
        """Publish setpoints, unless the goal ended or a peer fell silent while they were planned."""
        with self._sending:
            is_wanted = self._pursued is goal and not self.silent_peers
            if is_wanted:
                self._setpoints.publish(self._writer.write(setpoints))
        return is_wanted

    def _end(self, goal: PackGoal | FillGoal) -> None:
        """Hold the arm and let the action return."""
        with self._sending:
            if self._pursued is not goal:
                return
            self._pursued = None
            self._hold()
        self.end_goal()

    def _hold(self) -> None:
        if self._mailbox.joints is not None:
            self._setpoints.publish(self._writer.write(hold(self._mailbox.joints)))

    def on_peer(self, peer: str, is_alive: bool) -> None:
        """Hold the arm as soon as a peer falls silent; setpoints planned before are not sent after it."""
        with self._sending:
            super().on_peer(peer, is_alive)
            if not is_alive:
                self._hold()

    def on_lost_peers(self, peers: list[str]) -> None:
        self._fail(f"silent: {', '.join(peers)}")

    def on_arm_stop(self, reason: str) -> None:
        self._fail(reason)

    def give_up(self) -> None:
        self._fail(self._failure)

    def _fail(self, reason: str) -> None:
        if (goal := self._pursued) is not None:
            goal.finish(PackingExitReason.FAULT, self._mailbox.time, reason)
            self._end(goal)

    def _expire(self, goal: PackGoal | FillGoal) -> None:
        """End a goal whose time runs out while there is nothing to plan from."""
        goal.expire(self._mailbox.time)
        if goal.is_ended:
            self._end(goal)

    def _on_error(self, error: Exception) -> None:
        if isinstance(error, PackError):
            self.health.count("skipped iteration", str(error))
            self.get_logger().warning(f"iteration skipped: {error}", throttle_duration_sec=1.0)
        elif self.context.ok() and self.failures.note("iteration", error):
            self.react_to_failure(f"every iteration fails: {error!r}")


def load_kinematics(cell: PackingCell) -> None:
    """Have numba load the arm's kinematics: the first iteration of a goal would wait for it for a second."""
    arm_chain(cell).jacobian(np.zeros(len(cell.robot.arm.joints)))


def main() -> int:
    """Entry point of `mpc_node`."""
    return run_node(MpcNode)
