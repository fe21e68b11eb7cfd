"""Where one action can bring a block: the hole of a grid is reached by a push, not by a grasp."""

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
import shapely

from pack_core.blocks.plan import PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import Problem
from pack_evaluation.blocks.reach_drawing import carry_reach, draw_reach, push_reach, write_reach
from unit.problems import make_problem

CELLS = {name: (52.8 * (i % 3), 52.8 * (i // 3)) for i, name in enumerate("abcdefghi")}
HOLE = np.array(CELLS["b"]) / 1000
"""In the middle of the lower row, between two blocks."""


def with_block_b_at(*row: float) -> Problem:
    return make_problem(CELLS | {"b": row}, CELLS, size=0.6)


def test_the_hole_of_a_grid_is_out_of_reach_of_a_grasp_and_free_table_within() -> None:
    problem = with_block_b_at(52.8, -80.0)
    reach = carry_reach(problem, problem.starts, "b")
    assert not reach.contains(shapely.Point(HOLE))
    assert reach.contains(shapely.Point(-0.15, -0.15))
    assert not reach.contains(shapely.Point(-0.299, -0.15))  # it would stand over the edge of the workspace


def test_the_hole_of_a_grid_is_within_reach_of_a_push() -> None:
    problem = with_block_b_at(52.8, -80.0)
    at_goal = shapely.box(*(HOLE - 0.0254), *(HOLE + 0.0254))
    assert push_reach(problem, problem.starts, "b").buffer(1e-4).covers(at_goal)
    beyond = shapely.Point(HOLE + np.array([0.0, 0.04]))
    assert not push_reach(problem, problem.starts, "b").contains(beyond)


def test_a_single_gap_in_a_row_takes_a_block_between_the_fingers() -> None:
    """With nothing beside it on two sides, the place of a block at the corner of the grid can be filled."""
    problem = make_problem(CELLS | {"a": (-150, -150), "b": (150, -150)}, CELLS, size=0.6)
    poses = {**problem.starts, "d": PlanarPose(-0.1, 0.2)}
    assert carry_reach(problem, poses, "a").buffer(1e-4).contains(shapely.Point(0.0, 0.0))


def test_a_block_that_cannot_be_grasped_has_no_reach() -> None:
    problem = make_problem(
        {"a": (0, 0), "b": (54, 0), "c": (0, 54)}, {"a": (200, 200), "b": (54, 0), "c": (0, 54)}
    )
    assert carry_reach(problem, problem.starts, "a").is_empty


def a_plan(problem: Problem, *, has_push: bool) -> Plan:
    """Brings block b home in two actions."""
    start, before, home = problem.starts["b"], PlanarPose(0.0528, -0.08), problem.goals["b"]
    last = Push("b", before, home) if has_push else PickPlace("b", before, home, 0)
    return Plan(PlanStatus.FEASIBLE, (PickPlace("b", start, before, 0), last))


@pytest.mark.parametrize("has_push", [True, False])
def test_a_plan_s_picture_has_three_panels(has_push: bool) -> None:
    problem = with_block_b_at(200.0, -150.0)
    figure = draw_reach(problem, a_plan(problem, has_push=has_push))
    assert [axes.get_title()[:1] for axes in figure.axes] == ["b"] * 3


def test_a_plan_s_picture_is_written(tmp_path: Path) -> None:
    problem = with_block_b_at(200.0, -150.0)
    path = write_reach(problem, a_plan(problem, has_push=True), tmp_path / "reach.png")
    assert matplotlib.image.imread(path).std() > 0.0
