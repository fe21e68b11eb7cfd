"""Where the objects of a list shall stand, and in which order they come."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely

from pack_core.packing.cell import packing_cell
from pack_core.packing.free_space import footprint, is_inside
from pack_core.packing.goals import Arrangement, FillMethod
from pack_core.packing.objects import Box, Cylinder, ObjectModel
from pack_core.packing.packing_list import PackingList, PackingOrder
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_planner.filling.arrangement_planner import ArrangementConfig
from pack_planner.filling.fill_planner import FillPlanner

CELL = packing_cell()
CONFIG = ArrangementConfig()


def box(name: str, x: float, y: float, z: float) -> Box:
    return Box(name=name, shape="box", size=(x, y, z), mass=0.3)


def can(name: str, radius: float, height: float) -> Cylinder:
    return Cylinder(name=name, shape="cylinder", radius=radius, height=height, mass=0.3)


ITEMS: list[ObjectModel] = [
    box("tall", 0.09, 0.06, 0.2),
    can("low", 0.04, 0.05),
    box("middle", 0.1, 0.1, 0.1),
    can("can", 0.033, 0.12),
]
SCENE = PackingList(objects=ITEMS).start(CELL)
OUTSIDE = SceneState(0.0, {"tall": ObjectState(Pose(np.array([0.42, -0.36, 0.1])))})


def plan(
    items: list[ObjectModel], method: FillMethod = FillMethod.CONTACT,
    order: PackingOrder = PackingOrder.PLANNED,
    state: SceneState = OUTSIDE, planned: dict[str, Pose] | None = None,
) -> Arrangement:  # fmt: skip
    planner = FillPlanner(CONFIG, method, order)
    return planner.plan(SCENE, state, items, np.random.default_rng(3), planned or {})


def outlines(found: Arrangement) -> list[shapely.Polygon]:
    return [footprint(item, found.poses[item.name]) for item in ITEMS if item.name in found.poses]


@pytest.mark.parametrize(
    ("method", "gap"), [(FillMethod.CONTACT, CONFIG.gap), (FillMethod.NO_CONTACT, CONFIG.free_gap)]
)
def test_objects_stand_between_the_walls_and_keep_their_gaps(method: FillMethod, gap: float) -> None:
    found = plan(ITEMS, method)
    assert set(found.poses) == {item.name for item in ITEMS}
    assert all(is_inside(outline, SCENE.container) for outline in outlines(found))
    # outlines are simplified by 0.3 mm while they are arranged
    assert all(a.distance(b) > gap - 0.001 for a, b in combinations(outlines(found), 2))
    for item in ITEMS:
        assert found.poses[item.name].p[2] == pytest.approx(item.half_extents[2])


def test_the_lowest_come_first_unless_the_order_of_the_list_binds() -> None:
    assert plan(ITEMS).order == ("low", "middle", "can", "tall")
    assert plan(ITEMS, order=PackingOrder.LIST).order == ("tall", "low", "middle", "can")


def test_what_is_in_the_container_is_kept_clear_of() -> None:
    here = Pose(np.array([0.44, 0.05, 0.1]))
    state = SceneState(0.0, {"tall": ObjectState(here)})
    rest = [item for item in ITEMS if item.name != "tall"]
    standing = footprint(SCENE.new_object, here)
    assert all(outline.distance(standing) > 0.001 for outline in outlines(plan(rest, state=state)))


def test_an_earlier_arrangement_is_kept_though_an_object_yielded_into_it() -> None:
    first = plan(ITEMS)
    here = Pose(first.poses["tall"].p + np.array([0.004, 0.0, 0.0]), first.poses["tall"].q)
    state = SceneState(0.0, {"tall": ObjectState(here)})
    rest = [item for item in ITEMS if item.name != "tall"]
    again = plan(rest, state=state, planned=dict(first.poses))
    assert {name: X.p.tolist() for name, X in again.poses.items()} == {
        item.name: first.poses[item.name].p.tolist() for item in rest
    }


def test_what_fits_at_no_yaw_is_refused_with_its_size() -> None:
    giant = box("giant", 0.3, 0.3, 0.1)
    for method in FillMethod:
        found = plan([*ITEMS, giant], method)
        assert "0.300 x 0.300" in found.refused["giant"]
        assert "giant" not in found.order


def test_without_contact_what_finds_no_place_is_refused_and_with_contact_it_comes_last() -> None:
    many: list[ObjectModel] = [box(f"box_{i}", 0.12, 0.1, 0.1) for i in range(5)]
    free, close = plan(many, FillMethod.NO_CONTACT), plan(many)
    assert len(free.poses) < 5
    assert set(free.refused) == {item.name for item in many} - set(free.poses)
    assert not close.refused
    assert set(close.order[: len(close.poses)]) == set(close.poses)


def test_an_object_that_fits_beside_the_others_in_no_arrangement_is_refused_when_it_is_its_turn() -> None:
    boxes: list[ObjectModel] = [box(f"box_{i}", 0.12, 0.1, 0.1) for i in range(5)]
    close = plan(boxes)
    assert set(close.order) == {item.name for item in boxes}
    stands = {name: ObjectState(X_WO) for name, X_WO in close.poses.items()}
    assert len(stands) == 4
    (last,) = [item for item in boxes if item.name not in stands]
    others = [item for item in boxes if item.name in stands]
    scene = SCENE.model_copy(update={"objects": others, "new_object": last})
    planner = FillPlanner(CONFIG, FillMethod.CONTACT, PackingOrder.PLANNED)
    found = planner.plan(scene, SceneState(0.0, stands), [last], np.random.default_rng(3))
    assert found.order == ()
    assert set(found.refused) == {last.name}


def test_an_object_for_which_others_can_move_aside_is_tried() -> None:
    wide, high = box("wide", 0.13, 0.2, 0.1), box("new", 0.1, 0.2, 0.1)
    scene = SCENE.model_copy(update={"objects": [wide], "new_object": high})
    state = SceneState(0.0, {"wide": ObjectState(Pose(np.array([*SCENE.container.centre, 0.05])))})
    planner = FillPlanner(CONFIG, FillMethod.CONTACT, PackingOrder.PLANNED)
    found = planner.plan(scene, state, [high], np.random.default_rng(3))
    assert not found.poses
    assert found.order == ("new",)


def test_room_to_spare_is_shared_among_the_gaps() -> None:
    two = outlines(plan(ITEMS))
    assert min(a.distance(b) for a, b in combinations(two, 2)) > 2.0 * CONFIG.gap


def test_at_random_objects_come_as_listed_without_places() -> None:
    found = plan(ITEMS, FillMethod.RANDOM)
    assert found.order == tuple(item.name for item in ITEMS)
    assert not found.poses
