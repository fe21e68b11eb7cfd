"""Moves that the arm refuses: the table is looked at again, and the plan does without them."""

import numpy as np
import pytest

from block_fsm.executor_config import ExecutorConfig
from block_fsm.outcome import ExitReason
from block_fsm.requests import MoveArm, PlanFor
from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.primitive_action import PrimitiveKind
from pack_core.blocks.problem import Problem
from pack_core.motion.moves import PoseMove
from pack_core.rotations import yaw_of
from unit.block_fsm.table import Table, directly, staged

GOALS = {"a": PlanarPose(0.65, 0.0, 0.0), "b": PlanarPose(0.70, 0.0, 0.0)}
AWAY = PlanarPose(0.5, 0.2, 0.7)
STREWN = {"a": AWAY, "b": PlanarPose(0.8, -0.2, -2.5)}


class Refuser:
    """Refuses the first moves that begin with a segment of some label, up to a number of them."""

    def __init__(self, label: str, count: int = 1) -> None:
        self._label, self._left = label, count

    def __call__(self, move: MoveArm) -> bool:
        if move.path.segments[0].label != self._label:
            return False
        self._left -= 1
        return self._left >= 0


def problems(table: Table) -> list[Problem]:
    """That a plan was asked for, in order."""
    return [request.problem for request in table.asked if isinstance(request, PlanFor)]


def test_a_grasp_that_the_arm_cannot_reach_is_planned_around() -> None:
    table = Table({"a": AWAY}, refuses=Refuser("approach"))
    outcome = table.run({"a": GOALS["a"]})
    assert outcome.success
    assert (outcome.tally.refusals, outcome.tally.picks, outcome.tally.plans) == (1, 1, 3)
    refused = [problem.refused for problem in problems(table)]
    assert [[primitive.kind for primitive in primitives] for primitives in refused] == [
        [],
        [PrimitiveKind.GRASP],
        [],
    ]
    moves = [r.path.segments[0] for r in table.asked if isinstance(r, MoveArm)]
    first, second = (move for move in moves if isinstance(move, PoseMove))
    turn = yaw_of(second.X_WT.q) - yaw_of(first.X_WT.q)
    assert abs(np.sin(turn)) == pytest.approx(1.0)


def test_the_table_is_looked_at_again_after_a_refusal() -> None:
    def nudge(move: MoveArm) -> bool:
        if not is_refused(move):
            return False
        table.poses["a"] = AWAY.moved(0.01, 0.0)
        return True

    is_refused = Refuser("approach")
    table = Table({"a": AWAY}, refuses=nudge)
    assert table.run({"a": GOALS["a"]}).success
    assert problems(table)[1].starts["a"] == AWAY.moved(0.01, 0.0)


def test_a_block_that_cannot_be_carried_to_its_place_is_put_down_where_it_was() -> None:
    table = Table({"a": AWAY}, refuses=Refuser("lift"))
    outcome = table.run({"a": GOALS["a"]})
    assert outcome.success
    assert (outcome.tally.refusals, outcome.tally.picks, outcome.tally.failed_grasps) == (1, 1, 0)
    again = problems(table)[1]
    assert again.starts == {"a": AWAY}
    assert [primitive.kind for primitive in again.refused] == [PrimitiveKind.PLACE]
    assert again.refused[0].at.p == pytest.approx(GOALS["a"].p)


def test_a_push_that_is_not_possible_is_planned_around_from_above() -> None:
    def planner(problem: Problem) -> Plan:
        is_pushed = directly(problem).actions and not problem.refused
        plan = Plan(PlanStatus.FEASIBLE, staged("a", GOALS["a"], 0.0)[1:], 1)
        return plan if is_pushed else directly(problem)

    table = Table({"a": GOALS["a"].moved(-0.03, 0.0)}, planner, refuses=Refuser("push"))
    outcome = table.run({"a": GOALS["a"]})
    assert outcome.success
    assert (outcome.tally.refusals, outcome.tally.picks, outcome.tally.pushes) == (1, 1, 0)
    labels = [r.path.segments[0].label for r in table.asked if isinstance(r, MoveArm)]
    assert labels[labels.index("push") + 1] == "up"


def test_what_was_refused_is_forgotten_once_the_table_has_changed() -> None:
    lost: list[int] = []

    def holds(number: int) -> bool:
        lost.append(number)
        return number != 3

    table = Table(dict(STREWN), holds=holds, refuses=Refuser("approach"))
    assert table.run(GOALS).success
    assert [len(problem.refused) for problem in problems(table)] == [0, 1, 0, 0]


def test_an_arm_that_can_do_nothing_ends_the_task_with_the_reason() -> None:
    outcome = Table(dict(STREWN), refuses=Refuser("approach", 100)).run(GOALS)
    assert outcome.exit_reason is ExitReason.MOTION_FAILED
    assert outcome.tally.refusals == ExecutorConfig().refusals
    assert (outcome.tally.actions, outcome.tally.plans) == (0, ExecutorConfig().refusals)
    assert outcome.message == "5 actions in a row refused, the last: 'palm' would be 3 mm inside 'b'"


def test_a_plan_that_refusals_leave_no_way_to_says_so() -> None:
    def planner(problem: Problem) -> Plan:
        if not problem.refused:
            return directly(problem)
        return Plan(PlanStatus.TIMEOUT, diagnosis=Diagnosis("no plan found in 1.00 s"))

    outcome = Table(dict(STREWN), planner, refuses=Refuser("approach")).run(GOALS)
    assert outcome.exit_reason is ExitReason.NO_PLAN
    assert outcome.message.endswith("in 1.00 s; the arm refused: 'palm' would be 3 mm inside 'b'")


@pytest.mark.parametrize("label", ["look", "up", "back off"])
def test_an_arm_that_cannot_leave_ends_the_task(label: str) -> None:
    def planner(problem: Problem) -> Plan:
        plan = Plan(PlanStatus.FEASIBLE, staged("a", GOALS["a"], 0.0)[1:], 1)
        return plan if label == "back off" else directly(problem)

    table = Table({"a": GOALS["a"].moved(-0.03, 0.0)}, planner, refuses=Refuser(label))
    outcome = table.run({"a": GOALS["a"]})
    assert outcome.exit_reason is ExitReason.MOTION_FAILED
    assert outcome.tally.refusals == 0
