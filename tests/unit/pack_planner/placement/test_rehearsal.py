"""Rehearsed entries: what can be pushed aside, what cannot, and what is tipped over."""

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.convex_mesh import ConvexMesh
from pack_core.packing.entry import Entry, WayIn, plan_entry
from pack_core.packing.objects import Box, Capsule
from pack_core.packing.scene import Scene
from pack_core.rotations import Pose, angle_between, exp
from pack_planner.placement.rehearsal import DOWN_BELOW, REST, Rehearsal

PLACE = Pose(np.array([0.5, 0.0, 0.09]))
TOWARDS_Y = np.array([0.0, 1.0])


def block_at(y: float, width: float = 0.06) -> Scene:
    """A block 12 cm tall, beside or below the place."""
    block = Box(name="block", shape="box", size=(0.09, width, 0.12), mass=0.3)
    empty = packing_cell().scene.model_copy(update={"objects": [block]})
    return empty.with_poses({"block": Pose(np.array([0.5, y, 0.06]))})


def entry(scene: Scene, over: np.ndarray, lean: float = 0.4) -> Entry:
    return plan_entry(scene, PLACE, ("block",), scene.poses(), WayIn(over, lean))


def rehearse(
    scene: Scene, *entries: Entry, threads: int = 1, over: str = "{}"
) -> tuple[list[bool], list[float]]:
    rehearsal = Rehearsal(scene.description(), packing_cell(over), threads)
    seen = rehearsal.run(scene.poses(), [PLACE] * len(entries), entries)
    return seen.is_success.tolist(), seen.lags.tolist()


def test_into_free_space_it_comes_down_without_a_lag() -> None:
    scene = packing_cell().scene.model_copy(update={"objects": []})
    (success,), (lag,) = rehearse(scene, Entry())
    assert success
    assert abs(lag) < 0.01


def test_flat_on_top_of_a_block_it_stands_and_beside_it_comes_down() -> None:
    scene = block_at(0.02)
    (flat, leaning), lags = rehearse(scene, entry(scene, np.zeros(2)), entry(scene, TOWARDS_Y))
    assert not flat
    assert leaning
    assert lags[0] > REST * (0.12 - DOWN_BELOW) > lags[1]


def test_leaning_away_from_the_block_it_lands_on_it() -> None:
    scene = block_at(0.02)
    (over, away), _ = rehearse(scene, entry(scene, TOWARDS_Y), entry(scene, -TOWARDS_Y))
    assert over
    assert not away


def test_a_capsule_that_lies_and_has_rolled_has_not_tipped_over() -> None:
    roll = Capsule(name="roll", mass=0.1, shape="capsule", radius=0.02, length=0.08, axis="x")
    scene = packing_cell().scene.model_copy(update={"objects": [roll]})
    beside = np.array([0.5, 0.08, 0.02])
    for turned in (0.0, 0.5, 1.5, np.pi):
        (success,), _ = rehearse(scene.with_poses({"roll": Pose(beside, exp([turned, 0.0, 0.0]))}), Entry())
        assert success
    upended = Pose(np.array([0.5, 0.08, 0.04]), exp([0.0, np.pi / 2, 0.0]))
    rehearsal = Rehearsal(scene.description(), packing_cell(), 1)
    assert rehearsal._is_upright("roll", np.array([[*upended.p, *upended.q]])).tolist() == [False]


def test_what_fills_the_width_of_the_container_is_in_the_way() -> None:
    scene = block_at(0.0, width=0.21)
    (success,), _ = rehearse(scene, entry(scene, TOWARDS_Y))
    assert not success


def test_hardly_pushed_it_stays_on_top_of_the_block() -> None:
    scene = block_at(0.02)
    (success,), _ = rehearse(scene, entry(scene, TOWARDS_Y), over="push: {force: 0.2, moment: 0.02}")
    assert not success


@pytest.mark.parametrize("threads", [2, 3])
def test_the_same_on_any_number_of_threads(threads: int) -> None:
    scene = block_at(0.02)
    entries = [entry(scene, np.array([np.cos(a), np.sin(a)])) for a in range(5)]
    assert rehearse(scene, *entries) == rehearse(scene, *entries, threads=threads)


def test_what_looks_another_way_after_half_a_turn_is_not_turned_by_it() -> None:
    corners = [(-0.05, -0.04), (0.05, -0.04), (0.0, 0.04)]
    vertices = tuple((x, y, z) for x, y in corners for z in (-0.06, 0.06))
    wedge = ConvexMesh(name="wedge", shape="mesh", mass=0.2, vertices=vertices)
    scene = packing_cell().scene.model_copy(update={"objects": [], "new_object": wedge})
    rehearsal = Rehearsal(scene.description(), packing_cell(), 1)
    X_WN = Pose(np.array([0.5, 0.0, 0.06]), exp([0.0, 0.0, 2.5]))
    turned = exp(rehearsal._way_down(X_WN, Entry())[-1, 3:])
    assert angle_between(turned, X_WN.q) == pytest.approx(0.0, abs=1e-6)
