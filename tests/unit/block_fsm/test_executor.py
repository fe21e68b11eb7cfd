from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from block_fsm.executor_config import ExecutorConfig
from block_fsm.outcome import ExitReason
from block_fsm.requests import MoveArm, MoveFingers, NoPicture, PlanFor
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_core.motion.moves import Line
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner
from pack_planner.rearrangement.methods import RearrangementConfig
from pack_planner.rearrangement.planning import plan
from unit.block_fsm.table import SIDE, Table, directly, staged

GOALS = {"a": PlanarPose(0.65, 0.0, 0.0), "b": PlanarPose(0.70, 0.0, 0.0)}


APART = {"a": PlanarPose(0.60, 0.0, 0.0), "b": PlanarPose(0.75, 0.0, 0.0)}


def beam(problem: Problem) -> Plan:
    """A plan of the planner that knows obstacles."""
    return plan(problem, budget_s=20.0, config=RearrangementConfig(beam=BeamPlanner(rounds=2)))


def scattered() -> dict[str, PlanarPose]:
    return {"a": PlanarPose(0.5, 0.2, 0.7), "b": PlanarPose(0.8, -0.2, -2.5)}


def test_blocks_end_at_their_goals() -> None:
    table = Table(scattered())
    outcome = table.run(GOALS)
    assert outcome.success
    assert outcome.tally.picks == 2
    assert outcome.position_error < 1e-9
    for name, goal in GOALS.items():
        assert table.poses[name].p == pytest.approx(goal.p)
        assert np.cos(table.poses[name].yaw - goal.yaw) == pytest.approx(1.0)


def test_a_plan_is_not_shown_as_the_next_one() -> None:
    table = Table(scattered())
    table.run(GOALS)
    assert table.known == [None, None]


def test_nothing_is_done_where_all_blocks_are_in_place() -> None:
    outcome = Table(dict(GOALS)).run(GOALS)
    assert outcome.success
    assert outcome.tally.actions == 0


def with_stranger(pose: PlanarPose) -> Callable[[Mapping[str, PlanarPose]], BlockSighting]:
    """What is seen where somebody has put a block whose tag nobody knows."""
    return lambda poses: BlockSighting(0.0, {**poses, "tag 7": pose}, unknown=(7,))


@pytest.mark.usefixtures("compiled")
def test_a_strange_block_is_an_obstacle_to_plan_and_arm() -> None:
    table = Table(scattered(), beam, sighting=with_stranger(PlanarPose(0.6, 0.2, 0.3)))
    assert table.run(APART).success
    problems = [request.problem for request in table.asked if isinstance(request, PlanFor)]
    assert all(list(problem.obstacles) == ["tag 7"] for problem in problems)
    moves = [request for request in table.asked if isinstance(request, MoveArm)]
    assert all("tag 7" in {obstacle.name for obstacle in move.obstacles} for move in moves[1:])


@pytest.mark.usefixtures("compiled")
def test_a_strange_block_on_a_goal_ends_the_task_with_its_name() -> None:
    outcome = Table(scattered(), beam, sighting=with_stranger(APART["b"])).run(APART)
    assert outcome.exit_reason is ExitReason.NO_PLAN
    assert "tag 7 stands on the goal of" in outcome.message


@pytest.mark.usefixtures("compiled")
def test_a_strange_block_that_comes_while_a_plan_is_carried_out_is_planned_around() -> None:
    retreats: list[int] = []

    def sighting(poses: Mapping[str, PlanarPose]) -> BlockSighting:
        strange = with_stranger(PlanarPose(0.6, 0.2, 0.3))
        return strange(poses) if len(retreats) > 1 else BlockSighting(0.0, poses)

    table = Table(scattered(), beam, sighting=sighting, after=lambda _: retreats.append(0))
    outcome = table.run(APART)
    assert outcome.success
    problems = [request.problem for request in table.asked if isinstance(request, PlanFor)]
    assert [len(problem.obstacles) for problem in problems] == [0, 1, 1]


@pytest.mark.usefixtures("compiled")
def test_a_strange_block_that_is_taken_away_meanwhile_is_planned_without() -> None:
    retreats: list[int] = []

    def sighting(poses: Mapping[str, PlanarPose]) -> BlockSighting:
        strange = with_stranger(PlanarPose(0.6, 0.2, 0.3))
        return BlockSighting(0.0, poses) if len(retreats) > 1 else strange(poses)

    table = Table(scattered(), beam, sighting=sighting, after=lambda _: retreats.append(0))
    outcome = table.run(APART)
    assert outcome.success, outcome.message
    assert outcome.tally.disturbances == 1
    problems = [request.problem for request in table.asked if isinstance(request, PlanFor)]
    assert [len(problem.obstacles) for problem in problems] == [1, 0, 0]


def test_a_tag_on_something_that_is_no_block_ends_the_task_with_its_number() -> None:
    outcome = Table(scattered(), sighting=lambda poses: BlockSighting(0.0, poses, unknown=(7,))).run(APART)
    assert outcome.exit_reason is ExitReason.NOT_SEEN
    assert outcome.message == "on top of no block: tag 7"


def test_a_push_brings_a_block_home_along_its_line() -> None:
    def planner(problem: Problem) -> Plan:
        if not directly(problem).actions:
            return directly(problem)
        place, push = staged("a", GOALS["a"], np.pi / 2)
        return Plan(PlanStatus.FEASIBLE, (replace(place, start=problem.starts["a"]), push), 2)

    table = Table({"a": PlanarPose(0.5, 0.2, 0.7)}, planner)
    outcome = table.run({"a": GOALS["a"]})
    assert outcome.success
    assert (outcome.tally.picks, outcome.tally.pushes) == (1, 1)


def test_a_block_beside_its_push_line_is_not_pushed_but_planned_anew() -> None:
    asked: list[Problem] = []

    def planner(problem: Problem) -> Plan:
        asked.append(problem)
        if len(asked) > 1:
            return directly(problem)
        return Plan(PlanStatus.FEASIBLE, staged("a", GOALS["a"], 0.0)[1:], 1)

    beside = GOALS["a"].moved(-0.03, 0.0).moved(0.0015, np.pi / 2)
    outcome = Table({"a": beside}, planner).run({"a": GOALS["a"]})
    assert outcome.success
    assert outcome.tally.pushes == 0
    assert len(asked) == 3


def test_a_block_that_was_knocked_aside_is_noticed_and_planned_for_anew() -> None:
    def knock(table: Table) -> None:
        if not knocked and table.poses["a"].distance_to(GOALS["a"]) < 1e-6:
            knocked.append("b")
            table.poses["b"] = table.poses["b"].moved(0.02, 1.0)

    knocked: list[str] = []
    table = Table(scattered(), after=knock)
    outcome = table.run(GOALS)
    assert outcome.success
    assert outcome.tally.disturbances == 1
    assert sum(isinstance(request, PlanFor) for request in table.asked) == 3


def test_a_cell_that_is_reset_meanwhile_ends_the_task_with_the_blocks_that_are_gone() -> None:
    def reset(table: Table) -> None:
        if "a" in table.poses and table.poses["a"].distance_to(GOALS["a"]) < 1e-6:
            table.poses = {"z": table.poses["b"]}

    outcome = Table(scattered(), after=reset).run(GOALS)
    assert outcome.exit_reason is ExitReason.NOT_SEEN
    assert outcome.message == "no longer in the cell: a, b; was it reset?"


def test_a_grasp_that_holds_nothing_is_tried_again() -> None:
    table = Table(scattered(), holds=lambda number: number != 1)
    outcome = table.run(GOALS)
    assert outcome.success
    assert outcome.tally.failed_grasps == 1


def test_grasps_that_never_hold_end_the_task() -> None:
    outcome = Table(scattered(), holds=lambda number: False).run(GOALS)
    assert outcome.exit_reason is ExitReason.NO_PROGRESS
    assert outcome.tally.failed_grasps == ExecutorConfig().grasps


def test_a_block_of_another_width_is_put_back_and_named_if_it_stays_so() -> None:
    askew = Table(scattered(), width=lambda number: SIDE + (0.02 if number == 1 else -0.001))
    outcome = askew.run(GOALS)
    assert outcome.success
    assert outcome.tally.failed_grasps == 1
    starts = scattered()
    table = Table(scattered(), width=lambda number: 0.040)
    outcome = table.run(GOALS)
    assert outcome.exit_reason is ExitReason.NO_PROGRESS
    assert "held something 40.0 mm wide where block 'a', which is 50.8 mm wide, was seen" in outcome.message
    assert table.poses == starts
    assert not table.held


def test_a_block_lost_on_the_way_is_picked_up_where_it_lies() -> None:
    table = Table(scattered(), holds=lambda number: number != 2)
    outcome = table.run(GOALS)
    assert outcome.success
    assert outcome.tally.failed_grasps == 1


def test_a_tag_missed_once_is_looked_for_again() -> None:
    assert Table(scattered(), unseen=2).run(GOALS).success


def test_a_tag_missed_for_good_is_named() -> None:
    outcome = Table(scattered(), unseen=100).run(GOALS)
    assert outcome.exit_reason is ExitReason.NOT_SEEN
    assert "a" in outcome.message


def test_without_a_plan_the_reason_is_passed_on() -> None:
    refusal = Plan(PlanStatus.INFEASIBLE, diagnosis=Diagnosis("a and b cannot be moved"))
    outcome = Table(scattered(), lambda problem: refusal).run(GOALS)
    assert outcome.exit_reason is ExitReason.NO_PLAN
    assert "INFEASIBLE: a and b cannot be moved" in outcome.message


@pytest.mark.parametrize("label", ["approach", "down", "lift", "carry", "lower", "touch"])
def test_an_arm_that_meets_what_nobody_saw_puts_the_block_back_and_looks_again(label: str) -> None:
    table = Table(scattered(), stuck=label, times=1)
    outcome = table.run(GOALS)
    assert outcome.success
    assert outcome.tally.plans == 3


@pytest.mark.parametrize("label", ["down", "lift", "carry", "lower", "touch"])
def test_an_arm_that_meets_what_nobody_saw_goes_straight_up_from_there(label: str) -> None:
    table = Table(scattered(), stuck=label, times=1)
    assert table.run(GOALS).success
    ((request, X_WT),) = table.met
    moves = [asked for asked in table.asked if isinstance(asked, MoveArm)]
    up = moves[moves.index(request) + 1].path.segments[0]
    if isinstance(up, Line):  # from over all blocks it goes away at once
        assert up.X_WT.p[:2] == pytest.approx(X_WT.p[:2])
        assert up.X_WT.p[2] >= X_WT.p[2]


def test_an_arm_that_gets_stuck_ends_the_task() -> None:
    outcome = Table(scattered(), stuck="carry").run(GOALS)
    assert outcome.exit_reason is ExitReason.MOTION_FAILED
    assert "carry" in outcome.message


def test_blocks_that_never_get_home_end_the_task() -> None:
    def drift(table: Table) -> None:
        for name in table.poses:
            table.poses[name] = table.poses[name].moved(0.01, 0.3)

    assert Table(scattered(), after=drift).run(GOALS).exit_reason is ExitReason.NO_PROGRESS


def test_every_action_ends_with_the_arm_out_of_sight() -> None:
    table = Table(scattered())
    table.run(GOALS)
    for request, following in zip(table.asked, table.asked[1:], strict=False):
        if type(following).__name__ == "Look":
            assert isinstance(request, MoveArm)
            assert request.path.segments[-1].label == "look"


def test_fingers_open_wide_enough_before_they_come_down() -> None:
    table = Table(scattered())
    table.run(GOALS)
    for request, following in zip(table.asked, table.asked[1:], strict=False):
        if isinstance(following, MoveArm) and following.path.segments[0].label == "approach":
            assert isinstance(request, MoveFingers)
            assert request.command.opening > 0.0508


def test_a_tag_seen_twice_is_told_from_one_not_seen() -> None:
    table = Table(scattered(), sighting=lambda poses: BlockSighting(0.0, {}, missing=("a",), doubled=("b",)))
    outcome = table.run(GOALS)
    assert outcome.exit_reason is ExitReason.NOT_SEEN
    assert outcome.message == "not seen: a; seen more than once: b"


def test_a_camera_that_gives_no_picture_is_quoted() -> None:
    outcome = Table(scattered(), sighting=lambda poses: NoPicture("the camera does not answer")).run(GOALS)
    assert outcome.exit_reason is ExitReason.NOT_SEEN
    assert outcome.message == "the camera does not answer"


def moves(table: Table) -> dict[str, MoveArm]:
    """By the label of their first segment."""
    return {r.path.segments[0].label: r for r in table.asked if isinstance(r, MoveArm)}


def test_a_carried_block_is_no_obstacle_and_a_placed_one_is() -> None:
    table = Table({"a": PlanarPose(0.5, 0.2, 0.7), "b": GOALS["b"]})
    table.run(GOALS)
    asked = moves(table)
    assert {item.name for item in asked["approach"].obstacles} == {"table", "a", "b"}
    assert {item.name for item in asked["lift"].obstacles} == {"table", "b"}
    assert asked["lift"].carried is not None
    placed = next(item for item in asked["up"].obstacles if item.name == "a")
    assert placed.X_WO.p[:2] == pytest.approx(GOALS["a"].p)
    assert (asked["lift"].contacts, asked["up"].contacts) == ({"table"}, {"a"})


def test_a_block_may_touch_what_it_stands_beside_when_it_is_lifted() -> None:
    start = PlanarPose(0.5, 0.2, 0.0)
    table = Table({"a": start, "b": start.moved(0.0508 + 0.0004, 0.0), "c": start.moved(-0.06, 0.0)})
    table.run({"a": GOALS["a"], "b": table.poses["b"], "c": table.poses["c"]})
    assert moves(table)["lift"].contacts == {"table", "b"}


def test_moves_are_checked_with_the_fingers_as_they_stand() -> None:
    table = Table({"a": PlanarPose(0.5, 0.2, 0.7), "b": GOALS["b"]})
    table.run(GOALS)
    asked = moves(table)
    assert asked["approach"].opening == pytest.approx(0.0588)
    assert asked["lift"].opening == pytest.approx(0.0508)
    assert all(request.target(1).is_checked for request in asked.values())


def test_a_pushed_block_goes_with_the_fingers_and_stays_when_they_leave() -> None:
    def planner(problem: Problem) -> Plan:
        todo = directly(problem).actions
        return Plan(PlanStatus.FEASIBLE, staged("a", GOALS["a"], 0.0)[1:] if todo else (), 1)

    table = Table({"a": GOALS["a"].moved(-0.03, 0.0)}, planner)
    assert table.run({"a": GOALS["a"]}).success
    asked = moves(table)
    carried = asked["push"].carried
    assert carried is not None
    end = asked["push"].path.segments[-1]
    assert isinstance(end, Line)
    assert (end.X_WT @ carried.X_TB).p[:2] == pytest.approx(GOALS["a"].p)
    assert [item.name for item in asked["back off"].obstacles] == ["table", "a"]
