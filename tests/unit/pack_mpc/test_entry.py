"""How the held object enters among the others."""

import numpy as np
import pytest

from pack_core.rotations import Pose
from pack_core.scene.scene import Scene
from pack_mpc.entry import ASIDE_MARGIN, LANDING_MARGIN, UPRIGHT_BELOW, entry_at, may_land, plan_entry

PLACE = Pose(np.array([0.5, 0.0, 0.09]))


def at(x: float, y: float) -> Pose:
    return Pose(np.array([x, y, 0.06]))


def test_the_object_leans_over_its_obstacle(scene: Scene) -> None:
    entry = plan_entry(scene, PLACE, ("tea_box",), {"tea_box": at(0.5, 0.05)})
    np.testing.assert_allclose(entry.over, [0.0, 1.0])
    assert entry.tops == pytest.approx((0.13,))
    np.testing.assert_allclose(entry_at(entry, 0.2, 0.2)[0], [0.0, np.sin(0.2)])


def test_its_lower_end_keeps_off_what_it_would_land_on(scene: Scene) -> None:
    half = scene.new_object.half_extents[1] + scene.model_of("tea_box").half_extents[1]
    gone = plan_entry(scene, PLACE, ("tea_box",), {"tea_box": at(0.5, half - 0.01)})
    np.testing.assert_allclose(entry_at(gone, 0.2, 0.2)[1], [0.0, -0.01 - ASIDE_MARGIN], atol=1e-9)
    beside = plan_entry(scene, PLACE, ("tea_box",), {"tea_box": at(0.5, half + 0.001)})
    np.testing.assert_array_equal(beside.aside, 0.0)


@pytest.mark.parametrize("names", [(), ("tea_box",), ("tea_box", "soup_can")])
def test_it_may_land_until_it_is_below_the_walls_and_every_top(scene: Scene, names: tuple[str, ...]) -> None:
    entry = plan_entry(scene, PLACE, names, {"tea_box": at(0.5, 0.05), "soup_can": at(0.53, 0.05)})
    walls = scene.container.height
    lowest = min((walls, *entry.tops)) - LANDING_MARGIN
    assert may_land(entry, walls, lowest + 1e-6)
    assert not may_land(entry, walls, lowest - 1e-6)


def test_it_is_upright_once_it_is_down(scene: Scene) -> None:
    entry = plan_entry(scene, PLACE, ("tea_box",), {"tea_box": at(0.5, 0.05)})
    np.testing.assert_allclose(entry_at(entry, 0.2, UPRIGHT_BELOW), 0.0)
    axis, aside = entry_at(entry, 0.2, 0.5 * (UPRIGHT_BELOW + entry.tops[0]))
    np.testing.assert_allclose(axis, [0.0, np.sin(0.1)])
    np.testing.assert_allclose(aside, 0.5 * entry.aside)


def test_between_two_obstacles_there_is_no_side_to_lean_to(scene: Scene) -> None:
    poses = {"tea_box": at(0.5, 0.05), "soup_can": at(0.5, -0.05)}
    entry = plan_entry(scene, PLACE, ("tea_box", "soup_can"), poses)
    np.testing.assert_array_equal(entry.over, 0.0)


def test_without_obstacles_it_stays_upright(scene: Scene) -> None:
    np.testing.assert_array_equal(entry_at(plan_entry(scene, PLACE, (), {}), 0.2, 0.3), 0.0)
