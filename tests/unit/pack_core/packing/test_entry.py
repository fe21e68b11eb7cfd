"""How the held object enters among the others."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pack_core.packing.cell import packing_cell
from pack_core.packing.entry import (
    ASIDE_MARGIN,
    LANDING_MARGIN,
    UPRIGHT_BELOW,
    WALL_MARGIN,
    Entry,
    WayIn,
    plan_entry,
    side_of,
)
from pack_core.packing.free_space import footprint
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose

PLACE = Pose(np.array([0.5, 0.0, 0.09]))
LEAN = 0.2


@pytest.fixture(scope="module")
def scene() -> Scene:
    return packing_cell().scene


def at(x: float, y: float) -> Pose:
    return Pose(np.array([x, y, 0.06]))


def over_its_obstacles(scene: Scene, poses: dict[str, Pose], place: Pose = PLACE) -> Entry:
    names = tuple(poses)
    return plan_entry(scene, place, names, poses, WayIn(side_of(place, names, poses), LEAN))


def lower_face(scene: Scene, place: Pose, entry: Entry) -> Array:
    """The corners `(4, 2)` of the lower face in W, tilted and shifted as at the entry."""
    half, over = scene.new_object.half_extents, entry.over
    tilt = Rotation.from_rotvec(LEAN * np.array([-over[1], over[0], 0.0]))
    corners = np.array([[i * half[0], j * half[1], 0.0] for i in (-1, 1) for j in (-1, 1)])
    return np.asarray(place.p[:2] + entry.aside + tilt.apply(corners)[:, :2])


def test_the_object_leans_over_its_obstacle(scene: Scene) -> None:
    entry = over_its_obstacles(scene, {"tea_box": at(0.5, 0.05)})
    np.testing.assert_allclose(entry.over, [0.0, 1.0])
    assert entry.tops == pytest.approx((0.13,))
    np.testing.assert_allclose(entry.at(0.2)[0], [0.0, np.sin(LEAN)])


def test_its_lower_end_keeps_off_what_it_would_land_on(scene: Scene) -> None:
    half = scene.new_object.half_extents[1] + scene.model_of("tea_box").half_extents[1]
    gone = over_its_obstacles(scene, {"tea_box": at(0.5, half - 0.01)})
    np.testing.assert_allclose(gone.at(0.2)[1], [0.0, -0.01 - ASIDE_MARGIN], atol=1e-9)
    beside = over_its_obstacles(scene, {"tea_box": at(0.5, half + 0.001)})
    np.testing.assert_array_equal(beside.aside, 0.0)


@given(st.floats(0.39, 0.61), st.floats(-0.08, 0.08), st.floats(0.0, 2 * np.pi))
def test_its_lower_face_keeps_off_the_walls_unless_room_is_missing(x: float, y: float, angle: float) -> None:
    """The corners of the lower face, tilted and shifted as at the entry, about the height of the tops."""
    scene = packing_cell().scene
    half = scene.new_object.half_extents
    lower, upper = scene.container.lower + half[:2], scene.container.upper - half[:2]
    place = Pose(np.array([*np.clip([x, y], lower, upper), half[2]]))
    over = np.array([np.cos(angle), np.sin(angle)])
    entry = plan_entry(scene, place, ("tea_box",), {"tea_box": at(0.5, 0.0)}, WayIn(over, LEAN))
    face = lower_face(scene, place, entry)
    margin = min((face - scene.container.lower).min(), (scene.container.upper - face).min())
    assert margin >= -1e-9
    tea_box = footprint(scene.model_of("tea_box"), at(0.5, 0.0))
    overlap = footprint(scene.new_object, place).intersection(tea_box)
    depth = np.ptp(shapely.get_coordinates(overlap) @ over) if not overlap.is_empty else 0.0
    wanted = depth + ASIDE_MARGIN if depth > 0.0 else 0.0
    if -entry.aside @ over > wanted - 1e-9:  # nothing is missing beside the obstacle
        assert margin >= WALL_MARGIN - 1e-9


@pytest.mark.parametrize("room", [0.03, 0.013, 0.0065, 0.0])
def test_wall_and_obstacle_share_the_room_beside_it(scene: Scene, room: float) -> None:
    """The tilted lower face has `room` [m] to move between the wall behind it and its obstacle."""
    depth, over, half = 0.01, np.array([0.0, 1.0]), scene.new_object.half_extents
    y = scene.container.lower[1] + half[1] * np.cos(LEAN) + depth + room
    box = at(0.5, y + half[1] - depth + scene.model_of("tea_box").half_extents[1])
    place = Pose(np.array([0.5, y, half[2]]))
    entry = plan_entry(scene, place, ("tea_box",), {"tea_box": box}, WayIn(over, LEAN))
    share = min(room / (WALL_MARGIN + ASIDE_MARGIN), 1.0)
    assert -entry.aside[1] - depth == pytest.approx(share * ASIDE_MARGIN)
    behind = lower_face(scene, place, entry)[:, 1].min() - scene.container.lower[1]
    assert behind == pytest.approx(room - share * ASIDE_MARGIN)


def test_flush_with_a_wall_it_enters_off_the_wall_even_without_obstacles(scene: Scene) -> None:
    flush = scene.container.upper[0] - scene.new_object.half_extents[0]
    entry = plan_entry(scene, Pose(np.array([flush, 0.0, 0.09])), (), {}, WayIn(lean=LEAN))
    np.testing.assert_allclose(entry.at(1.0)[1], [-WALL_MARGIN, 0.0], atol=1e-9)
    np.testing.assert_allclose(entry.at(UPRIGHT_BELOW)[1], 0.0)


def test_an_offset_of_its_own_is_kept_and_may_begin_above_anything(scene: Scene) -> None:
    way = WayIn(np.array([0.6, 0.8]), LEAN, back=0.05)
    poses = {"tea_box": at(0.5, 0.05)}
    entry = plan_entry(scene, PLACE, ("tea_box",), poses, way)
    np.testing.assert_allclose(entry.at(0.2)[1], [-0.03, -0.04])
    assert max(entry.tops) == 2.0 * max(scene.model_of(name).half_extents[2] for name in scene.names)
    assert scene.container.height in entry.tops


@pytest.mark.parametrize("names", [(), ("tea_box",), ("tea_box", "soup_can")])
def test_it_may_land_until_it_is_below_the_walls_and_every_top(scene: Scene, names: tuple[str, ...]) -> None:
    poses = {"tea_box": at(0.5, 0.05), "soup_can": at(0.53, 0.05)}
    entry = over_its_obstacles(scene, {name: poses[name] for name in names})
    walls = scene.container.height
    lowest = min((walls, *entry.tops)) - LANDING_MARGIN
    assert entry.may_land(walls, lowest + 1e-6)
    assert not entry.may_land(walls, lowest - 1e-6)


@pytest.mark.parametrize(
    ("gap", "reach", "counts"), [(0.01, 0.015, True), (0.02, 0.015, False), (0.01, 0.0, False)]
)
def test_it_may_land_on_a_neighbour_within_reach(
    scene: Scene, gap: float, reach: float, counts: bool
) -> None:
    half = scene.new_object.half_extents[1] + scene.model_of("sugar_box").half_extents[1]
    far = {name: at(2.0, 2.0) for name in scene.names}
    poses = far | {"sugar_box": at(0.5, half + gap)}
    entry = plan_entry(scene, PLACE, (), poses, WayIn(lean=LEAN), reach)
    assert entry.beside == (pytest.approx((0.11,)) if counts else ())
    assert entry.may_land(0.3, 0.08) == (counts or False)


def test_it_is_upright_once_it_is_down(scene: Scene) -> None:
    entry = over_its_obstacles(scene, {"tea_box": at(0.5, 0.05)})
    axes, asides = entry.at(np.array([0.0, UPRIGHT_BELOW, 0.5 * (UPRIGHT_BELOW + entry.tops[0])]))
    np.testing.assert_allclose(axes, [[0.0, 0.0], [0.0, 0.0], [0.0, np.sin(0.5 * LEAN)]])
    np.testing.assert_allclose(asides, [[0.0, 0.0], [0.0, 0.0], 0.5 * entry.aside])


def test_between_two_obstacles_there_is_no_side_to_lean_to(scene: Scene) -> None:
    entry = over_its_obstacles(scene, {"tea_box": at(0.5, 0.05), "soup_can": at(0.5, -0.05)})
    np.testing.assert_array_equal(entry.over, 0.0)
    np.testing.assert_array_equal(entry.aside, 0.0)


def test_without_obstacles_it_stays_upright(scene: Scene) -> None:
    np.testing.assert_array_equal(over_its_obstacles(scene, {}).at(0.3), 0.0)
