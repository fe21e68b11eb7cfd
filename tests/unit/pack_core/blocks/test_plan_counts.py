"""What is counted of a plan: blocks that are cleared, and blocks that are grasped anew."""

from pack_core.blocks.plan import PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose

GOALS = {"a": PlanarPose(0.0, 0.0), "b": PlanarPose(0.1, 0.0)}
START, ASIDE = PlanarPose(0.3, 0.3, 0.5), PlanarPose(-0.2, 0.0, 0.2)


def test_a_block_counts_as_cleared_wherever_its_actions_in_a_row_do_not_end_at_its_goal() -> None:
    clear, home = PickPlace("a", START, ASIDE, 0), PickPlace("a", ASIDE, GOALS["a"], 0)
    other = PickPlace("b", START, GOALS["b"], 1)
    assert Plan(PlanStatus.FEASIBLE, (clear, other, home)).cleared(GOALS) == 1
    assert Plan(PlanStatus.FEASIBLE, (clear, home, other)).cleared(GOALS) == 0
    assert Plan(PlanStatus.FEASIBLE, (other, clear)).cleared(GOALS) == 1
    assert Plan(PlanStatus.OPTIMAL).cleared(GOALS) == 0


def test_a_block_counts_as_regrasped_where_it_is_carried_twice_in_a_row() -> None:
    first, second = PickPlace("a", START, ASIDE, 0), PickPlace("a", ASIDE, GOALS["a"], 1)
    other, push = PickPlace("b", START, GOALS["b"], 1), Push("a", ASIDE, GOALS["a"])
    assert Plan(PlanStatus.FEASIBLE, (first, second, other)).regrasps() == 1
    assert Plan(PlanStatus.FEASIBLE, (first, other, second)).regrasps() == 0
    assert Plan(PlanStatus.FEASIBLE, (first, push)).regrasps() == 0
