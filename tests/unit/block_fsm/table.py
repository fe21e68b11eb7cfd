"""A table whose arm does exactly as it is told, and fails where a test says so."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from block_fsm.executor import Executor
from block_fsm.executor_config import ExecutorConfig
from block_fsm.motions import Motions, TableObstacles
from block_fsm.outcome import Outcome
from block_fsm.requests import Answer, ExecutorRequest, Look, MoveArm, MoveFingers, NoPicture, PlanFor
from block_fsm.task import RearrangeTask
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.gripper import FingerState, FingerStatus
from pack_core.blocks.plan import Action, PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.primitive_action import is_refused
from pack_core.blocks.problem import CUBES, Problem
from pack_core.motion.moves import Line, PoseMove
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.rotations import Pose, yaw_of

SIDE = 0.0508
TOOL_AT_LOOK = Pose(np.array([0.4, -0.3, 0.4]), np.array([0.0, 0.0, 1.0, 0.0]))
SQUARE = ((0.3, -0.4), (1.0, -0.4), (1.0, 0.4), (0.3, 0.4))


def directly(problem: Problem) -> Plan:
    """Every block that is not at its goal, picked and placed there by a grasp that was not refused."""
    actions = []
    for name, pose in problem.starts.items():
        if pose.distance_to(problem.goals[name]) > problem.tolerance.position:
            ways = [PickPlace(name, pose, problem.goals[name], grasp) for grasp in (0, 1)]
            actions.append(next((way for way in ways if not is_refused(way, problem.refused)), ways[0]))
    return Plan(PlanStatus.FEASIBLE, tuple(actions), len(actions))


@dataclass
class Table:
    """Blocks that are where they were put.

    Attributes:
        poses: X_WB by id.
        planner: answers requests for plans.
        after: is called with the table after every retreat of the arm.
        holds: says of each closing of the fingers whether they hold something.
        width: says of each closing how far apart the pads stand then, where they hold something [m].
        unseen: how many pictures in a row miss a block.
        sighting: what is told of a picture, from the poses.
        stuck: label of a segment at which the arm gets stuck.
        times: how often it still does.
        refuses: says of a move whether it is refused.
        met: moves in which the arm got stuck, with X_WT there.
        known: what the executor gave as its plan whenever it asked for one.
    """

    poses: dict[str, PlanarPose]
    planner: Callable[[Problem], Plan] = directly
    after: Callable[["Table"], None] = lambda table: None
    holds: Callable[[int], bool] = lambda number: True
    width: Callable[[int], float] = lambda number: SIDE
    unseen: int = 0
    sighting: Callable[[Mapping[str, PlanarPose]], BlockSighting | NoPicture] = lambda poses: BlockSighting(
        0.0, poses
    )
    stuck: str = ""
    times: int = 1000
    refuses: Callable[[MoveArm], bool] = lambda move: False
    met: list[tuple[MoveArm, Pose]] = field(default_factory=list)
    known: list[Plan | None] = field(default_factory=list)
    closings: int = 0
    asked: list[ExecutorRequest] = field(default_factory=list)
    held: str = ""
    tool: Pose = TOOL_AT_LOOK

    def run(self, goals: Mapping[str, PlanarPose], config: ExecutorConfig | None = None) -> Outcome:
        task, config = RearrangeTask(goals, SQUARE), config or ExecutorConfig()
        motions = Motions(config, CUBES, task.gripper, np.zeros(6), TOOL_AT_LOOK)
        executor = Executor(task, config, motions, TableObstacles(blocks_cell()), 60.0)
        request: ExecutorRequest | None = executor.start()
        while request is not None:
            self.asked.append(request)
            self.known += [executor.plan] if isinstance(request, PlanFor) else []
            request = executor.answer(self._answer(request))
        assert executor.outcome is not None
        return executor.outcome

    def _answer(self, request: ExecutorRequest) -> Answer:
        if isinstance(request, Look):
            return self._look()
        if isinstance(request, PlanFor):
            return self.planner(request.problem)
        return self._move(request) if isinstance(request, MoveArm) else self._fingers(request)

    def _look(self) -> BlockSighting | NoPicture:
        self.unseen -= 1
        if self.unseen >= 0:
            missing, *rest = self.poses
            return BlockSighting(0.0, {name: self.poses[name] for name in rest}, missing=(missing,))
        return self.sighting(dict(self.poses))

    def _move(self, request: MoveArm) -> MotionStatus:
        if self.refuses(request):
            return self._status(MotionState.REFUSED, "", "'palm' would be 3 mm inside 'b'")
        for segment in request.path.segments:
            if segment.label == self.stuck and self.times:
                self.times -= 1
                self.met.append((request, self.tool))
                return self._status(MotionState.STUCK, segment.label, "something is in the way")
            if isinstance(segment, Line | PoseMove):
                self._carry(segment.X_WT, segment.label == "push")
        if request.path.segments[-1].label == "look":
            self.after(self)
        return self._status(MotionState.REACHED, "", "")

    def _status(self, state: MotionState, label: str, reason: str) -> MotionStatus:
        return MotionStatus(0.0, 1, state, 0, label, 0.0, 0.0, 0.0, 0.0, 3, reason, self.tool)

    def _carry(self, X_WT: Pose, is_push: bool) -> None:
        before, self.tool = self.tool, X_WT
        name = self.held or (self._nearest(before) if is_push else "")
        if name:
            step, turn = X_WT.p - before.p, yaw_of(X_WT.q) - yaw_of(before.q)
            old = self.poses[name]
            standoff = 0.005 * step / np.linalg.norm(step) if is_push else np.zeros(3)
            x, y, _ = np.array([old.x, old.y, 0.0]) + step - standoff
            self.poses[name] = PlanarPose(float(x), float(y), old.yaw + turn)

    def _fingers(self, request: MoveFingers) -> FingerState:
        opening, status = request.command.opening, FingerStatus.AT_OPENING
        if opening < SIDE and opening > 0.02:
            self.closings += 1
            if self.holds(self.closings):
                status, opening = FingerStatus.HOLDING, self.width(self.closings)
                self.held = self.held or self._nearest(self.tool)
            else:
                self.held = ""
        else:
            self.held = ""
        return FingerState(0.0, opening, 60.0, status)

    def _nearest(self, X_WT: Pose) -> str:
        return min(self.poses, key=lambda name: float(np.linalg.norm(self.poses[name].p - X_WT.p[:2])))


def staged(name: str, goal: PlanarPose, direction: float, distance: float = 0.03) -> tuple[Action, Action]:
    """A block brought behind its goal and pushed there; its start is for the caller to say."""
    stage = goal.moved(-distance, direction)
    return PickPlace(name, stage, stage, 0), Push(name, stage, goal)
