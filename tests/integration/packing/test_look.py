"""Goals that begin while the held object hides others: the arm moves it aside, and then it is packed."""

from __future__ import annotations

from pathlib import Path

from integration.harness import Graph
from integration.packing.cell_rig import Cell
from integration.packing.hidden_scene import FROM_ABOVE, write_hidden_scene
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import PackingExitReason, PackingMethod
from pack_core.packing.scene_file import load_scene
from pack_core.ros.contracts import packing as contracts
from pack_lockstep.packing.lockstep import Lockstep, Step
from pack_lockstep.packing.lockstep_config import lockstep_config

FACTOR = 0.3


def test_what_the_held_object_hides_is_looked_for_and_then_it_is_packed(tmp_path: Path) -> None:
    scene, steps = load_scene(write_hidden_scene(tmp_path)), list[Step]()
    config = lockstep_config()
    # The held object hides the others again while it goes down between them, and no camera looks from a side.
    session = config.session.model_copy(update={"blind_time": 5.0})
    config = config.model_copy(update={"session": session})
    lockstep = Lockstep(packing_cell(FROM_ABOVE), scene, config, PackingMethod.PACK_IT_IN, 0)
    outcome = lockstep.run(steps.append)
    assert outcome.exit_reason is PackingExitReason.PLACED, outcome.message
    assert list(dict.fromkeys(step.stage for step in steps)) == ["LOOK", "PRE_PACK", "INSERT", "FINE_TUNE"]
    assert "tea_box" not in steps[0].seen.scene.objects
    # Looking does not touch anything, so the goal's forces are those of packing.
    looks = [step for step in steps if step.stage == "LOOK"]
    bottom = scene.new_object.half_extents[2]
    assert min(step.truth.objects["passata"].X_WO.p[2] for step in looks) - bottom > scene.rim
    run = lockstep.recorded()
    assert run.iterations.stages[0] == "LOOK"
    assert run.iterations.placements[len(looks) - 1] == 0


def test_the_node_says_what_it_is_looking_for_and_asks_for_a_placement_afterwards(
    graph: Graph, tmp_path: Path
) -> None:
    cell = Cell(graph, FACTOR, write_hidden_scene(tmp_path), FROM_ABOVE, unseen="soup_can, tea_box")
    handle = cell.pack()
    assert handle.accepted
    graph.wait_until(lambda: cell.feedback and cell.feedback[-1].stage != "LOOK", timeout=60.0)
    assert cell.feedback[0].stage == "LOOK"
    first = graph.probe.mail[contracts.MPC_STATUS.name][0]
    assert (first.stage, first.placements) == ("LOOK", 0)
    assert first.warning.startswith("looking for ")
    assert "tea_box" in first.warning
    graph.wait_until(lambda: graph.probe.last(contracts.MPC_STATUS).placements == 1, timeout=60.0)
    handle.cancel_goal_async()
    assert graph.result_of(handle).exit_reason == "canceled"
