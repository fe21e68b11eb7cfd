"""What somebody does to the blocks cell by hand, while it picks and pushes blocks into a dense square."""

from __future__ import annotations

import numpy as np

from block_fsm.outcome import Outcome
from block_fsm.phase import Phase
from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers, PlanFor
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.planar import turn_between
from pack_core.blocks.problem_file import load_problem
from pack_core.paths import config_path
from pack_core.states import SceneState
from pack_lockstep.blocks.execution import MAX_ANGLE_DEG, MAX_ERROR
from pack_lockstep.blocks.hand_deeds import (
    AWAY,
    CAMERA,
    DEEDS,
    FREE,
    ON_GOAL,
    REMOVED,
    SHIFTED,
    STRANGER,
    TURNED,
    BlocksReach,
)
from pack_lockstep.blocks.lockstep import BlocksLockstep
from pack_lockstep.blocks.planning import CountedPlanner, CountedPlannerConfig
from pack_lockstep.blocks.settings import lockstep_config
from pack_lockstep.hands import HandCase, HandReport, Hands

PROBLEM = config_path("scenarios", "blocks", "example.yaml")
INTO = 0.3
"""Time in a request after which the hand reaches in [s]; in shorter ones at their end, before a picture at
once."""
STRANGER_MOVED = 0.001
"""From where a hand put it, by the arm [m]."""


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
    """What a moment is called in which something is asked for; empty for those in which no hand comes."""
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


class HandInBlocks:
    """Waits for its moment, does its deed once, and notes when the cell first acts on it.

    Args:
        case: what is done, and when.
        reach: what the hand can reach.
    """

    def __init__(self, case: HandCase, reach: BlocksReach) -> None:
        self._case, self._reach = case, reach
        self._since: float | None = None
        self.done: float | None = None
        self.noticed: float | None = None

    def on_request(self, request: ExecutorRequest, _: SceneState) -> None:
        """Look whether the moment has come, or has passed by too quickly."""
        executor = self._reach.cell.executor
        if self._since is not None and self.done is None:
            self._act()
        if self.done is not None:
            if self.noticed is None and isinstance(request, PlanFor):
                self.noticed = self._time
            return
        if executor.action is not None:
            self._reach.block = executor.action.block
        if moment_of(request, executor.phase) == self._case.when:
            self._since = self._time
            if isinstance(request, Look):
                self._act()

    def on_step(self) -> None:
        """Do the deed once the moment has lasted."""
        if self.done is None and self._since is not None and self._time > self._since + INTO:
            self._act()

    def _act(self) -> None:
        self.done = self._time
        DEEDS[self._case.what](self._reach)

    @property
    def _time(self) -> float:
        return self._reach.cell.simulator.time


def run_case(case: HandCase, seed: int) -> HandReport:
    """Carry out the problem, and do by hand what the case says."""
    cell, problem, config = blocks_cell(), load_problem(PROBLEM), lockstep_config()
    task = RearrangeTask(problem.goals, problem.workspace, problem.side, problem.symmetry, problem.gripper)
    planner = CountedPlanner(CountedPlannerConfig(seed=seed), config.planner)
    lockstep = BlocksLockstep(cell, task, problem.starts, planner, config, {STRANGER: AWAY})
    reach = BlocksReach(lockstep, problem, next(iter(problem.goals)))
    hand = HandInBlocks(case, reach)
    outcome = lockstep.run(hand.on_request, hand.on_step)
    return _report(case, reach, hand, outcome)


def _report(case: HandCase, reach: BlocksReach, hand: HandInBlocks, outcome: Outcome) -> HandReport:
    end, tally = reach.cell.simulator.time, outcome.tally
    said = {
        outcome.message: not outcome.success, f"{tally.plans} plans": tally.plans > 2,
        f"{tally.failed_grasps} grasps held nothing": tally.failed_grasps > 0,
        f"{tally.deviations} actions not as predicted": tally.deviations > 0,
        f"{tally.disturbances} actions after which others were elsewhere": tally.disturbances > 0,
    }  # fmt: skip
    noticed = tuple(text for text, is_so in said.items() if is_so)
    when = hand.noticed if hand.noticed is not None else end
    poses = reach.poses
    errors = [
        (poses[name].distance_to(goal), abs(turn_between(poses[name], goal, reach.problem.symmetry)))
        for name, goal in reach.problem.goals.items()
    ]
    are_home = [d <= MAX_ERROR and np.rad2deg(a) <= MAX_ANGLE_DEG for d, a in errors]
    is_pushed = reach.put is not None and reach.put.distance_to(poses[STRANGER]) > STRANGER_MOVED
    return HandReport(
        case.name, case.what, case.when, noticed=noticed,
        noticed_after=when - hand.done if noticed and hand.done is not None else float("nan"),
        ended=outcome.exit_reason.value, in_place=f"{sum(are_home)} of {len(are_home)}",
        error_mm=1e3 * max(d for d, _ in errors) if outcome.success else float("nan"),
        angle_deg=float(np.rad2deg(max(a for _, a in errors))) if outcome.success else float("nan"),
        touches=int(is_pushed), problem="" if hand.done is not None else "the state was not reached",
    )  # fmt: skip


HANDS = Hands(
    tuple(HandCase(what, when) for when, deeds in MOMENTS.items() for what in deeds), run_case,
    "worst: of all blocks, where the cell says that they are arranged; contacts: strange blocks it moved",
)  # fmt: skip
