from dataclasses import replace

import numpy as np
import pytest

from pack_core.errors import BagError
from pack_core.packing.topics import SCENE, SETTLED_SAMPLES
from pack_lockstep.packing.lockstep_config import PackingPreset, load_preset
from pack_lockstep.packing.planner_replay import replay_planner, requests
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


def test_a_preset_may_say_how_containers_are_filled() -> None:
    preset = PackingPreset(mpc={"fill": {}})
    assert replay_planner(sample(), seed=SEED, preset=preset).agrees


def test_what_is_done_before_the_first_answer_is_no_placement() -> None:
    run = sample_run()
    waiting = run.iterations.placements.copy()
    waiting[: len(waiting) // 4] = 0.0
    (request,) = requests(replace(run, iterations=replace(run.iterations, placements=waiting)), [run.start])
    assert request.planned_for == run.start
    assert request.tried.size == 0


def test_a_placement_that_was_taken_up_is_the_last_that_was_planned_before() -> None:
    """Of the sample's one placement, two are made; the planner was asked twice in between."""
    run = sample_run()
    done = run.iterations
    new = done.times.size // 2
    is_new = np.arange(done.times.size) >= new
    p_WT = np.where(is_new[:, None], done.p_WT + 0.03, done.p_WT)
    two = replace(run, iterations=replace(done, placements=np.where(is_new, 2.0, 1.0), p_WT=p_WT))
    start, early, taken, late = done.times[0] - 0.01, *done.times[[new - 9, new - 5, new + 3]]
    first, second = requests(two, [start, early, early, taken, late])  # one was sent again
    assert first.planned_for == start
    assert first.tried.size == 0
    assert second.planned_for == taken
    assert (first.answers, second.answers) == (0, 2)
    np.testing.assert_array_equal(second.tried, [done.p_WT[0]])
    np.testing.assert_array_equal(second.p_WT, p_WT[new])


def test_a_recording_without_the_planners_messages_is_refused() -> None:
    with pytest.raises(BagError, match=f"no message of {SETTLED_SAMPLES} before placement 1"):
        list(requests(sample_run(), []))
