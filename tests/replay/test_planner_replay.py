from dataclasses import replace

import numpy as np
import pytest

from pack_core.packing.topics import SCENE
from pack_lockstep.packing.presets import PackingPreset, load_preset
from pack_lockstep.packing.replay.planner import replay_planner, requests
from replay.sample import COUNTS, SEED, sample, sample_run


def test_the_core_chooses_the_placement_that_the_node_chose() -> None:
    found = replay_planner(sample(), seed=SEED)
    assert found.inputs[SCENE] == COUNTS[SCENE]
    assert found.agrees, found.rows
    assert len(found.rows) == sample_run().outcome["placements"]


def test_another_seed_gives_another_placement() -> None:
    assert not replay_planner(sample(), seed=SEED + 1).agrees


def test_a_preset_that_changes_the_planner_gives_another_placement() -> None:
    assert replay_planner(sample(), seed=SEED, preset=load_preset("ideal")).agrees
    assert not replay_planner(sample(), seed=SEED, preset=PackingPreset(planner={"samples": 20})).agrees


def test_what_is_done_before_the_first_answer_is_no_placement() -> None:
    run = sample_run()
    waiting = run.iterations.placements.copy()
    waiting[: len(waiting) // 4] = 0.0
    (request,) = requests(replace(run, iterations=replace(run.iterations, placements=waiting)))
    assert request.sent == run.start
    assert request.tried.size == 0


@pytest.mark.parametrize("stalled_in", ["INSERT", "FINE_TUNE"])
def test_a_second_placement_is_asked_for_once_the_object_is_out_after_a_stall(stalled_in: str) -> None:
    """Of the sample's one placement, two are made; in the last quarter the object is above the others."""
    run = sample_run()
    done, n = run.iterations, run.iterations.times.size
    stages = ["PRE_PACK"] * (n // 3) + [stalled_in] * (n // 3) + ["PRE_PACK"] * (n - 2 * (n // 3))
    out, new = n - n // 4, n - n // 6
    placements = np.where(np.arange(n) < new, 1.0, 2.0)
    p_WT = np.where(placements[:, None] == 2.0, done.p_WT + 0.03, done.p_WT)
    stalled = replace(done, stages=tuple(stages), placements=placements, p_WT=p_WT)
    held = run.estimate[run.held]
    bottoms = np.where(held.times < done.times[out] - 1e-3, run.scene.rim - 0.01, run.scene.rim + 0.01)
    raised = replace(held, p=np.column_stack([held.p[:, :2], bottoms + run.scene.new_object.half_extents[2]]))
    moved = replace(run, iterations=stalled, estimate=run.estimate | {run.held: raised})
    first, second = requests(moved)
    assert first.sent == run.start
    assert first.tried.size == 0
    assert done.times[out] <= second.sent <= done.times[out + 2]
    np.testing.assert_array_equal(second.tried, [done.p_WT[0]])
    np.testing.assert_array_equal(second.p_WT, p_WT[new])
