"""Which placement is entered, and leaning to which side."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.entry import plan_entry
from pack_core.packing.objects import Box
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose
from pack_planner.placement.approach import OFF, ApproachConfig, ApproachPlanner
from pack_planner.placement.approach_options import beside
from pack_planner.placement.placement_result import PlacementCandidate
from pack_planner.placement.rehearsal import Rehearsal

LEAN = 0.4
RNG = partial(np.random.default_rng, 0)
SMALL = Box(name="small", shape="box", size=(0.09, 0.06, 0.12), mass=0.3)
LARGE = Box(name="large", shape="box", size=(0.13, 0.20, 0.12), mass=20.0)
ONTO_SMALL = PlacementCandidate(Pose(np.array([0.57, 0.0, 0.09])), ("small",), 0.02)
ONTO_LARGE = PlacementCandidate(Pose(np.array([0.43, 0.01, 0.09])), ("large",), 0.01)
CANDIDATES = [ONTO_LARGE, ONTO_SMALL]
ONCE = 1 + len(OFF)
"""Rehearsals of an entry that succeeds: as planned, and with its goal off in each direction."""


@pytest.fixture
def scene() -> Scene:
    """A block that can be pushed aside, and one on which everything lands."""
    empty = packing_cell().scene.model_copy(update={"objects": [SMALL, LARGE]})
    poses = {"small": Pose(np.array([0.57, 0.02, 0.06])), "large": Pose(np.array([0.43, 0.0, 0.06]))}
    return empty.with_poses(poses)


def planner(scene: Scene, **config: float) -> ApproachPlanner:
    return ApproachPlanner(
        scene.description(), packing_cell(), ApproachConfig(**{"crowded": 0.0} | config), threads=1
    )


def alone(_candidate: PlacementCandidate) -> list[PlacementCandidate]:
    """No variations."""
    return []


def test_where_there_is_room_the_first_is_entered_over_its_obstacles_unrehearsed(scene: Scene) -> None:
    covered = (0.09 * 0.06 + 0.13 * 0.20 + 0.065**2) / (0.27 * 0.22)
    roomy, tight = (planner(scene, crowded=covered + margin) for margin in (1e-3, -1e-3))
    for chooser, failures, expected in [
        (roomy, 0, ONTO_LARGE),
        (roomy, 1, ONTO_SMALL),
        (tight, 0, ONTO_SMALL),
    ]:
        choice, _ = chooser.choose(CANDIDATES, alone, scene.poses(), LEAN, failures, RNG())
        assert choice.X_WN is expected.X_WN


def test_where_obstacles_leave_no_side_to_lean_to_the_first_is_rehearsed_too(scene: Scene) -> None:
    between = replace(ONTO_LARGE, X_WN=Pose(np.array([0.5, 0.0, 0.09])), collisions=("large", "small"))
    poses = {"large": Pose(np.array([0.43, 0.0, 0.06])), "small": Pose(np.array([0.57, 0.0, 0.06]))}
    one_sided = replace(ONTO_SMALL, X_WN=Pose(np.array([0.57, -0.03, 0.09])))
    roomy = planner(scene, crowded=1.0)
    assert not beside(between, poses, LEAN).way.over.any()
    assert roomy.choose([between, one_sided], alone, poses, LEAN, failures=0, rng=RNG())[1] > 0
    assert roomy.choose([one_sided], alone, poses, LEAN, failures=0, rng=RNG())[1] == 0


def test_what_is_entered_easily_over_its_obstacles_needs_no_further_round(scene: Scene) -> None:
    easy = replace(ONTO_SMALL, X_WN=Pose(np.array([0.57, -0.02, 0.09])))
    choice, count = planner(scene).choose([easy], alone, scene.poses(), LEAN, failures=0, rng=RNG())
    assert choice.X_WN is easy.X_WN
    np.testing.assert_allclose(choice.way.over, [0.0, 1.0])
    assert count == ONCE


def test_one_that_can_be_entered_is_chosen_before_a_cheaper_one(scene: Scene) -> None:
    choice, _ = planner(scene).choose(CANDIDATES, alone, scene.poses(), LEAN, failures=0, rng=RNG())
    assert choice.X_WN is ONTO_SMALL.X_WN
    assert choice.way.over[1] > 0.5


def test_a_hopeless_search_takes_all_rounds_and_still_answers(scene: Scene) -> None:
    hopeless = [replace(ONTO_LARGE, cost=0.01 * i) for i in range(2)]
    search = planner(scene, likely=1, rounds=3, random=5)
    choice, count = search.choose(hopeless, alone, scene.poses(), LEAN, failures=0, rng=RNG())
    assert count == 1 + 3 * 5
    assert choice.X_WN is ONTO_LARGE.X_WN


def test_where_every_planned_entry_fails_a_random_one_is_found(scene: Scene) -> None:
    """Without its obstacle in the list, the object would come straight down onto it."""
    unaware = replace(ONTO_SMALL, X_WN=Pose(np.array([0.57, 0.02, 0.09])), collisions=())
    choice, count = planner(scene).choose([unaware], alone, scene.poses(), LEAN, failures=0, rng=RNG())
    assert count > ONCE
    assert choice.way.back is not None
    entry = plan_entry(scene, choice.X_WN, (), scene.poses(), choice.way)
    rehearsed = Rehearsal(scene.description(), packing_cell(), threads=1)
    assert rehearsed.run(scene.poses(), [choice.X_WN], [entry]).is_success.all()


def test_of_many_random_entries_those_over_gaps_are_worth_a_rehearsal(scene: Scene) -> None:
    unaware = replace(ONTO_SMALL, X_WN=Pose(np.array([0.57, 0.02, 0.09])), collisions=())
    rehearsal = Rehearsal(scene.description(), packing_cell(), threads=1)

    def found(drawn: int) -> int:
        """In how many of ten searches that rehearse two random entries one succeeds."""
        search, successes = planner(scene, rounds=1, drawn=drawn, random=2), 0
        for seed in range(10):
            rng = np.random.default_rng(seed)
            choice, _ = search.choose([unaware], alone, scene.poses(), LEAN, failures=0, rng=rng)
            entry = plan_entry(scene, choice.X_WN, (), scene.poses(), choice.way)
            successes += int(rehearsal.run(scene.poses(), [choice.X_WN], [entry]).is_success[0])
        return successes

    assert found(300) > found(2)


def test_variations_of_what_can_be_entered_are_rehearsed_too(scene: Scene) -> None:
    further = replace(ONTO_SMALL, X_WN=Pose(np.array([0.57, -0.03, 0.09])))
    costly = replace(ONTO_SMALL, cost=0.7)
    choice, count = planner(scene, sides=2, finalists=1).choose(
        [costly], lambda _: [further], scene.poses(), LEAN, failures=0, rng=RNG()
    )
    assert choice.X_WN is further.X_WN
    turns, sides = 3, 3
    assert count == ONCE + turns + sides + len(OFF)


def test_where_there_is_hope_all_rounds_are_taken(scene: Scene) -> None:
    costly = [replace(ONTO_SMALL, cost=1.1 - 0.01 * i) for i in range(9)]
    search = planner(scene, fresh=1, likely=1, rounds=3, sides=2, finalists=1)
    _, count = search.choose(costly, alone, scene.poses(), LEAN, failures=0, rng=RNG())
    sides = 3
    assert count == ONCE + 3 * (sides + len(OFF))


def test_variations_of_what_is_hopeless_are_not(scene: Scene) -> None:
    def refuse(_candidate: PlacementCandidate) -> list[PlacementCandidate]:
        raise AssertionError("varied")

    few = planner(scene, rounds=1, random=1)
    assert few.choose([ONTO_LARGE], refuse, scene.poses(), LEAN, failures=0, rng=RNG())[1] == 2


def test_where_nothing_is_in_the_way_it_comes_down_straight(scene: Scene) -> None:
    free = PlacementCandidate(Pose(np.array([0.5, -0.07, 0.09])), (), 0.0)
    choice, count = planner(scene).choose([free], alone, scene.poses(), LEAN, failures=0, rng=RNG())
    np.testing.assert_array_equal(choice.way.over, 0.0)
    assert count == ONCE
