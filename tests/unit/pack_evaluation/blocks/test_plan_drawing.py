"""A plan's pictures: one for the start, one an action."""

from pathlib import Path

import matplotlib.image
import pytest

from pack_core.blocks.plan import Plan, PlanStatus
from pack_evaluation.blocks.plan_drawing import draw_plan, write_plan
from pack_planner.rearrangement.beam.beam_planner import BeamPlanner
from pack_planner.rearrangement.instances import make_instance
from pack_planner.rearrangement.methods import RearrangementConfig
from pack_planner.rearrangement.planning import plan

SHORT = RearrangementConfig(beam=BeamPlanner(rounds=2))


@pytest.mark.usefixtures("compiled")
def test_every_action_has_a_picture_that_says_what_it_is() -> None:
    problem = make_instance(4, 0.1, 1)
    made = plan(problem, budget_s=20.0, config=SHORT)
    figure = draw_plan(problem, made, columns=3)
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert titles[0] == "start"
    assert len(titles) == 1 + len(made.actions)
    for title, action in zip(titles[1:], made.actions, strict=True):
        assert action.block in title
    assert f"lower bound {made.lower_bound}" in figure.get_suptitle()


@pytest.mark.parametrize("status", [PlanStatus.TIMEOUT, PlanStatus.INFEASIBLE])
def test_without_a_plan_the_start_is_drawn_and_why(status: PlanStatus, tmp_path: Path) -> None:
    path = write_plan(make_instance(4, 0.1, 1), Plan(status), tmp_path / "plans" / "none.png")
    assert matplotlib.image.imread(path).std() > 0.0
