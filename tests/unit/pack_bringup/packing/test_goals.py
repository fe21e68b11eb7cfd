"""A goal that fills a container: by a running cell, or in a job that starts one."""

from pathlib import Path

from pack_bringup.packing.goals import fill_goal, packing_fill_job, wanted_list
from pack_core.packing.cell import packing_cell
from pack_core.packing.packing_list import parse_list
from pack_core.paths import config_path
from pack_lockstep.packing.lockstep_config import load_preset
from pack_sim.packing.sim_node import wanted_scene

EXAMPLE = config_path("packing_lists", "example.yaml")


def test_the_cell_is_emptied_and_the_first_object_handed_over() -> None:
    contract, request = fill_goal(3, EXAMPLE).reset()
    start = wanted_scene(request, load_preset("iiwa14").packing_cell())
    assert start.container.centre == (0.56, 0.0)  # of the cell that is asked
    assert contract.name == "/sim/reset"
    assert not start.objects
    assert start.new_object.name == wanted_list(3, EXAMPLE, packing_cell()).objects[0].name
    assert start.new_object.pose is not None


def test_the_same_seed_draws_the_same_list_for_a_goal_and_for_a_job(tmp_path: Path) -> None:
    goal = fill_goal(500, None)
    job = packing_fill_job(500, None, folder=tmp_path, preset="", real_time_factor=None, command="")
    assert goal.list_text == job.list_text
    assert len(parse_list(goal.list_text, "list", packing_cell()).objects) == 8
    assert job.goal() == goal.goal()
