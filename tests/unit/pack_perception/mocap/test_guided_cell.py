"""Physics whose arm goes where it was measured to be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import HeldRole
from pack_core.packing.objects import Box, Capsule
from pack_core.rotations import Array
from pack_perception.mocap.guided_cell import GuidedCell
from unit.pack_perception.mocap.pushing import standing_scene

SCENE = standing_scene()
HOME = np.array(packing_cell().robot.home)


def sample(time: float) -> JointSample:
    return JointSample(time, HOME, np.zeros(7), np.zeros(7))


@pytest.fixture
def cell() -> GuidedCell:
    """All objects where they stand, the arm at home."""
    cell = GuidedCell(SCENE.description(), packing_cell(), HeldRole.RIGID, step=0.004)
    poses = np.array([[*X.p, *X.q] for X in SCENE.poses().values()])
    cell.correct(np.arange(len(poses)), poses, np.zeros((len(poses), 6)))
    cell.set_arm(sample(0.0))
    return cell


def test_objects_at_rest_stay_at_rest(cell: GuidedCell) -> None:
    before = cell.poses()
    for k in range(100):
        assert cell.follow(sample(0.004 * k), sample(0.004 * (k + 1))) == []
    assert np.allclose(cell.poses()[:, :3], before[:, :3], atol=5e-4)


@pytest.mark.parametrize("speed", [20.0, float("inf"), float("nan")])
def test_diverging_objects_are_put_back_and_stopped(cell: GuidedCell, speed: float) -> None:
    before = cell.poses()
    cell.correct(np.array([2]), before[2:3], np.array([[0.0, 0.0, speed, 0.0, 0.0, 0.0]]))
    back = cell.follow(sample(0.0), sample(0.004))
    assert cell.free[2] in back
    assert np.array_equal(cell.poses()[2], before[2])
    assert np.all(cell.twists()[2] == 0.0)
    assert cell.follow(sample(0.004), sample(0.008)) == []


def test_twists_are_in_world_axes(cell: GuidedCell) -> None:
    rows, poses = np.array([2]), cell.poses()[2:3]
    poses[0, 3:] = [0.0, 1.0, 0.0, 0.0]
    twist = np.array([[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]])
    cell.correct(rows, poses, twist)
    assert np.allclose(cell.twists()[2], twist[0])


def test_the_new_object_is_free_only_when_it_is_not_held() -> None:
    free = {
        held: GuidedCell(SCENE, packing_cell(), held, step=0.004).free
        for held in (HeldRole.RIGID, HeldRole.FREE)
    }
    assert free[HeldRole.RIGID] == SCENE.names
    assert free[HeldRole.FREE] == [*SCENE.names, SCENE.new_object.name]


def test_what_is_set_into_something_is_pushed_apart_and_does_not_roll_on() -> None:
    kiwi = Capsule(name="kiwi", shape="capsule", mass=0.07, radius=0.022, length=0.06, axis="x")
    box = Box(name="box", shape="box", mass=0.3, size=(0.08, 0.08, 0.06))
    scene = SCENE.model_copy(update={"objects": [kiwi, box]})
    # 2 mm into each other
    poses = np.array([[0.5, -0.06, 0.022, 1.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.03, 1.0, 0.0, 0.0, 0.0]])
    rows, nothing = np.arange(2), np.zeros((2, 6))

    def later(start: Callable[[GuidedCell], Array]) -> Array:
        cell = GuidedCell(scene.description(), packing_cell(), HeldRole.RIGID, step=0.004)
        cell.set_arm(sample(0.0))
        cell.correct(rows, start(cell), nothing)
        for k in range(100):
            cell.follow(sample(0.004 * k), sample(0.004 * (k + 1)))
        return np.asarray(cell.poses()[:, 1] - poses[:, 1])

    apart = later(lambda cell: cell.pushed_apart(rows, poses))
    assert np.abs(apart).max() < 0.003
    assert apart[1] - apart[0] == pytest.approx(0.002, abs=0.001)
    assert later(lambda _: poses)[0] < -0.01
