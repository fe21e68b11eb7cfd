"""How the held object enters among the others."""

import numpy as np
import pytest

from pack_core.rotations import Pose
from pack_core.scene.scene import Scene
from pack_mpc.entry import UPRIGHT_BELOW, lean_at, plan_entry

PLACE = Pose(np.array([0.5, 0.0, 0.09]))


def at(x: float, y: float) -> Pose:
    return Pose(np.array([x, y, 0.06]))


def test_the_object_leans_over_its_obstacle(scene: Scene) -> None:
    entry = plan_entry(scene, PLACE, ("tea_box",), {"tea_box": at(0.5, 0.05)})
    np.testing.assert_allclose(entry.over, [0.0, 1.0])
    assert entry.tops == pytest.approx((0.13,))
    np.testing.assert_allclose(lean_at(entry, 0.2, 0.2), [0.0, np.sin(0.2)])


def test_it_is_upright_once_it_is_down(scene: Scene) -> None:
    entry = plan_entry(scene, PLACE, ("tea_box",), {"tea_box": at(0.5, 0.05)})
    np.testing.assert_allclose(lean_at(entry, 0.2, UPRIGHT_BELOW), 0.0)
    half_way = lean_at(entry, 0.2, 0.5 * (UPRIGHT_BELOW + entry.tops[0]))
    np.testing.assert_allclose(half_way, [0.0, np.sin(0.1)])


def test_between_two_obstacles_there_is_no_side_to_lean_to(scene: Scene) -> None:
    poses = {"tea_box": at(0.5, 0.05), "soup_can": at(0.5, -0.05)}
    entry = plan_entry(scene, PLACE, ("tea_box", "soup_can"), poses)
    np.testing.assert_array_equal(entry.over, 0.0)


def test_without_obstacles_it_stays_upright(scene: Scene) -> None:
    np.testing.assert_array_equal(lean_at(plan_entry(scene, PLACE, (), {}), 0.2, 0.3), 0.0)
