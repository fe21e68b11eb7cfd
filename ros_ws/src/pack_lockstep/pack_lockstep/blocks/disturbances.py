"""What is done to blocks and camera of the blocks cell while it makes a dense square of its blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from block_fsm.outcome import Outcome, Phase
from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers, PlanFor
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.planar import PlanarPose, turn_between
from pack_core.blocks.problem import CUBE, Problem
from pack_core.blocks.problem_file import load_problem
from pack_core.paths import config_path
from pack_core.rotations import Array, Pose
from pack_core.states import SceneState
from pack_lockstep.blocks.execution import MAX_ANGLE_DEG, MAX_ERROR
from pack_lockstep.blocks.lockstep import BlocksLockstep, CountedPlanner, CountedPlannerConfig
from pack_lockstep.blocks.settings import lockstep_config
from pack_lockstep.disturbances import Disturbance, DisturbanceReport, DisturbanceTable

PROBLEM = config_path("scenarios", "blocks", "example.yaml")
INTO = 0.3
"""Time in a request before a change is made [s]: at the end of shorter ones, at once before a picture."""
FOREIGN_MOVED = 0.001
"""By the arm, from where it was put [m]."""
FOREIGN = "foreign"
"""A block whose tag nobody knows; it is out of reach until it is put somewhere."""
AWAY = PlanarPose(100.0, 100.0, 0.0)
"""Where nothing reaches or sees it [m]."""
TURN, SHIFT = np.deg2rad(20.0), 0.015
"""By which a block is turned and shifted [rad, m]: more than its grasp forgives."""


@dataclass
class BlocksSite:
    """Where a change is made: the cell at work, the problem, and the block that is meant."""

    cell: BlocksLockstep
    problem: Problem
    block: str
    put: PlanarPose | None = None

    @property
    def poses(self) -> dict[str, PlanarPose]:
        """Where all blocks truly are."""
        return {name: PlanarPose.of(o.X_WO) for name, o in self.cell.simulator.truth().objects.items()}

    def move(self, block: str, pose: PlanarPose) -> None:
        """Put a block somewhere on the table."""
        self.cell.simulator.put(block, pose.pose(0.5 * self.problem.sizes.get(block, CUBE).z))

    def bring(self, pose: PlanarPose) -> None:
        """Put the foreign block somewhere on the table."""
        self.put = pose
        self.move(FOREIGN, pose)


BlocksChange = Callable[[BlocksSite], None]


def _remove(site: BlocksSite) -> None:
    site.cell.simulator.put(site.block, Pose(np.array([*AWAY.p, 0.0])))


def _turn(site: BlocksSite) -> None:
    pose = site.poses[site.block]
    site.move(site.block, PlanarPose(pose.x, pose.y, pose.yaw + TURN))


def _shift(site: BlocksSite) -> None:
    """Away from the nearest other block."""
    poses = site.poses
    pose = poses[site.block]
    nearest = min((p for name, p in poses.items() if name != site.block), key=pose.distance_to)
    away = (pose.p - nearest.p) / pose.distance_to(nearest)
    site.move(site.block, PlanarPose(pose.x + SHIFT * away[0], pose.y + SHIFT * away[1], pose.yaw))


def _add_in_free_place(site: BlocksSite) -> None:
    taken = [*site.poses.values(), *site.problem.goals.values()]
    site.bring(_farthest(_lattice(site.problem), taken))


def _add_on_goal(site: BlocksSite) -> None:
    goals = list(site.problem.goals.values())
    site.bring(_farthest(goals, list(site.poses.values())))


def _silence_camera(site: BlocksSite) -> None:
    site.cell.camera_is_silent = True


def _lattice(problem: Problem) -> list[PlanarPose]:
    """Places within the workspace, its outermost ones left out."""
    corners: Array = np.array(problem.workspace)
    low, high = corners.min(axis=0) + CUBE.x, corners.max(axis=0) - CUBE.x
    return [PlanarPose(x, y, 0.3) for x in np.linspace(low[0], high[0], 15)
            for y in np.linspace(low[1], high[1], 15)]  # fmt: skip


def _farthest(places: list[PlanarPose], taken: list[PlanarPose]) -> PlanarPose:
    return max(places, key=lambda place: min(place.distance_to(other) for other in taken))


CHANGES: dict[str, BlocksChange] = {
    "block removed": _remove,
    "block turned by 20 degrees": _turn,
    "block shifted by 15 mm": _shift,
    "another block put in a free place": _add_in_free_place,
    "another block put on a goal": _add_on_goal,
    "camera silent": _silence_camera,
}
REMOVED, TURNED, SHIFTED, FREE, ON_GOAL, CAMERA = CHANGES

_ALL = (REMOVED, TURNED, SHIFTED, FREE, ON_GOAL)
MOMENTS: dict[str, tuple[str, ...]] = {
    "picture": (*_ALL, CAMERA),
    "plan": _ALL,
    "approach to pick": _ALL,
    "grasp": (REMOVED,),
    "carry": (REMOVED, FREE, ON_GOAL),
    "let go": (REMOVED,),
    "retreat": _ALL,
    "approach to push": (REMOVED, TURNED, SHIFTED, FREE),
    "push": (REMOVED, FREE),
    "back off": (REMOVED, TURNED, SHIFTED),
}
"""What is done, by what the executor has asked for in that moment."""
LABELS = {"lift": "carry", "up": "retreat", "push": "push", "back off": "back off"}
FINGERS = {Phase.PICK: "grasp", Phase.RETREAT: "let go"}


def moment_of(request: ExecutorRequest, phase: Phase) -> str:
    """What a moment is called in which something is asked for; empty if nothing is changed in it."""
    match request:
        case Look():
            return "picture"
        case PlanFor():
            return "plan"
        case MoveFingers():
            return FINGERS.get(phase, "")
        case MoveArm(path):
            label = path.segments[0].label
            return f"approach to {phase.value.lower()}" if label == "approach" else LABELS.get(label, "")


class BlocksDisturber:
    """Waits for its moment, makes its change once, and notes when the cell first acts on it.

    Args:
        case: what is done, and when.
        site: where it is made.
    """

    def __init__(self, case: Disturbance, site: BlocksSite) -> None:
        self._case, self._site = case, site
        self._since: float | None = None
        self.done: float | None = None
        self.noticed: float | None = None

    def on_request(self, request: ExecutorRequest, _: SceneState) -> None:
        """Look whether the moment has come, or has passed by too quickly."""
        executor = self._site.cell.executor
        if self._since is not None and self.done is None:
            self._act()
        if self.done is not None:
            if self.noticed is None and isinstance(request, PlanFor):
                self.noticed = self._time
            return
        if executor.action is not None:
            self._site.block = executor.action.block
        if moment_of(request, executor.phase) == self._case.when:
            self._since = self._time
            if isinstance(request, Look):
                self._act()

    def on_step(self) -> None:
        """Make the change once the moment has lasted."""
        if self.done is None and self._since is not None and self._time > self._since + INTO:
            self._act()

    def _act(self) -> None:
        self.done = self._time
        CHANGES[self._case.what](self._site)

    @property
    def _time(self) -> float:
        return self._site.cell.simulator.time


def run_case(case: Disturbance, seed: int) -> DisturbanceReport:
    """Carry out the problem, and disturb it as the case says."""
    cell, problem, config = blocks_cell(), load_problem(PROBLEM), lockstep_config()
    task = RearrangeTask.of(problem)
    planner = CountedPlanner(CountedPlannerConfig(seed=seed), config.planner)
    lockstep = BlocksLockstep(cell, task, problem.starts, planner, config, {FOREIGN: AWAY})
    site = BlocksSite(lockstep, problem, next(iter(problem.goals)))
    disturber = BlocksDisturber(case, site)
    outcome = lockstep.run(disturber.on_request, disturber.on_step)
    return _report(case, site, disturber, outcome)


def _report(
    case: Disturbance, site: BlocksSite, disturber: BlocksDisturber, outcome: Outcome
) -> DisturbanceReport:
    end, tally = site.cell.simulator.time, outcome.tally
    said = {
        outcome.message: not outcome.success, f"{tally.plans} plans": tally.plans > 2,
        f"{tally.failed_grasps} grasps held nothing": tally.failed_grasps > 0,
        f"{tally.deviations} actions not as predicted": tally.deviations > 0,
        f"{tally.disturbances} actions after which others were elsewhere": tally.disturbances > 0,
    }  # fmt: skip
    noticed = tuple(text for text, is_so in said.items() if is_so)
    when = disturber.noticed if disturber.noticed is not None else end
    poses = site.poses
    errors = [
        (poses[name].distance_to(goal), abs(turn_between(poses[name], goal, site.problem.symmetry)))
        for name, goal in site.problem.goals.items()
    ]
    are_home = [d <= MAX_ERROR and np.rad2deg(a) <= MAX_ANGLE_DEG for d, a in errors]
    is_pushed = site.put is not None and site.put.distance_to(poses[FOREIGN]) > FOREIGN_MOVED
    return DisturbanceReport(
        case.name, case.what, case.when, noticed=noticed,
        noticed_after=when - disturber.done if noticed and disturber.done is not None else float("nan"),
        ended=outcome.exit_reason.value, in_place=f"{sum(are_home)} of {len(are_home)}",
        error_mm=1e3 * max(d for d, _ in errors) if outcome.success else float("nan"),
        angle_deg=float(np.rad2deg(max(a for _, a in errors))) if outcome.success else float("nan"),
        touches=int(is_pushed), problem="" if disturber.done is not None else "the state was not reached",
    )  # fmt: skip


DISTURBANCES = DisturbanceTable(
    tuple(Disturbance(what, when) for when, changes in MOMENTS.items() for what in changes), run_case,
    "worst: of all blocks, where the cell says that they are arranged; contacts: strange blocks it moved",
)  # fmt: skip
