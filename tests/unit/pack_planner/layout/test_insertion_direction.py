"""A box comes from the side that opens the gaps to what it would touch, along the longest free corridor."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.errors import PackError
from pack_core.palletizing.orders.layout_plan import Insertion
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_planner.layout.insertion_direction import (
    SIDES,
    InsertionConfig,
    candidates,
    choose_insertion,
    ray_to_rectangle,
)
from unit.pack_planner.layout.blocks import PALLET, block, grids

CONFIG = InsertionConfig()
TARGET = block("target", 0.5, 0.3)
EAST, WEST = block("east", 0.802, 0.3), block("west", 0.198, 0.3)
NORTH, SOUTH = block("north", 0.5, 0.502), block("south", 0.5, 0.098)


def chosen(*placed: PlacedBox) -> Insertion:
    return choose_insertion(TARGET, placed, CONFIG, PALLET)


@pytest.mark.parametrize(
    ("placed", "direction"),
    [
        ((), "Center"),
        ((EAST,), "West"),
        ((WEST,), "East"),
        ((NORTH,), "South"),
        ((SOUTH,), "North"),
        ((EAST, NORTH), "Southwest"),
        ((WEST, NORTH), "Southeast"),
        ((WEST, SOUTH), "Northeast"),
        ((EAST, SOUTH), "Northwest"),
        ((EAST, WEST), "Center"),
        ((EAST, WEST, NORTH), "South"),
        ((EAST, WEST, NORTH, SOUTH), "Center"),
    ],
)
def test_it_comes_from_the_side_opposite_to_its_neighbours(
    placed: tuple[PlacedBox, ...], direction: str
) -> None:
    assert chosen(*placed).direction == direction


def test_neighbours_further_than_the_inflation_do_not_count() -> None:
    assert chosen(EAST.moved((0.009, 0, 0))).direction == "Center"
    assert chosen(EAST.moved((0.0079, 0, 0))).direction == "West"


def test_boxes_that_do_not_reach_into_its_height_do_not_count() -> None:
    upper = TARGET.moved((0, 0, 0.2))
    assert choose_insertion(upper, [EAST, NORTH, TARGET], CONFIG, PALLET).direction == "Center"


def test_a_corridor_ends_at_the_inflated_outline_of_what_is_in_the_way() -> None:
    blocker = WEST.moved((-0.1, 0, 0))  # 102 mm of room
    insertion = next(
        item.insertion
        for item in candidates(TARGET, [EAST, blocker], CONFIG)
        if item.insertion.direction == "West"
    )
    assert insertion.corridor == pytest.approx(0.102 - CONFIG.inflation)
    np.testing.assert_allclose(insertion.start(TARGET.centre), [0.65 - 0.092, 0.4, 0.1])


@pytest.mark.parametrize(
    ("side", "blocker"),
    [
        ("East", EAST.moved((0.1, 0, 0))),
        ("West", WEST.moved((-0.1, 0, 0))),
        ("North", NORTH.moved((0, 0.1, 0))),
        ("South", SOUTH.moved((0, -0.1, 0))),
    ],
)
def test_a_corridor_is_as_long_to_every_side_as_there_is_room(side: str, blocker: PlacedBox) -> None:
    corridors = {
        item.insertion.direction: item.insertion.corridor for item in candidates(TARGET, [blocker], CONFIG)
    }
    assert corridors.pop(side) == pytest.approx(0.102 - CONFIG.inflation)
    opposite = {"East": "West", "West": "East", "North": "South", "South": "North"}[side]
    assert corridors[opposite] == CONFIG.reach


def test_the_sides_go_around_the_compass_clockwise_from_north() -> None:
    headings = np.degrees([np.arctan2(east, north) for east, north in SIDES.values()]) % 360.0
    np.testing.assert_allclose(headings, 45.0 * np.arange(8))
    assert list(SIDES) == [
        "North", "Northeast", "East", "Southeast", "South", "Southwest", "West", "Northwest",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("gap_x", "gap_y", "direction"),
    [
        (0.004, 0.002, "West"),
        (0.002, 0.004, "South"),
        (0.002, 0.002, "South"),
        (0.002 + 1e-9, 0.002, "South"),
    ],
)
def test_a_box_at_a_corner_is_left_along_the_axis_that_parts_them_more(
    gap_x: float, gap_y: float, direction: str
) -> None:
    assert chosen(block("corner", 0.8 + gap_x, 0.5 + gap_y)).direction == direction


def test_a_corridor_as_short_as_may_be_is_of_use() -> None:
    config = InsertionConfig(reach=0.02, min_corridor=0.02)
    assert choose_insertion(TARGET, [EAST], config, PALLET).corridor == 0.02


def test_the_longest_corridor_wins_over_the_straightest_way() -> None:
    blocker = WEST.moved((-0.1, 0.15, 0))
    assert chosen(EAST, blocker).direction == "Southwest"


def test_a_corridor_too_short_to_be_of_use_is_not_taken() -> None:
    blockers = [WEST.moved((-0.02, dy, 0)) for dy in (-0.21, 0.0, 0.21)]
    assert chosen(EAST, *blockers).direction == "Center"


def test_beyond_the_pallets_border_the_way_is_free() -> None:
    target = block("target", 0.9, 0.3)
    assert choose_insertion(target, [block("west", 0.598, 0.3)], CONFIG, PALLET).corridor == CONFIG.reach


def test_offsets_stay_within_the_corridor() -> None:
    insertion = Insertion("West", np.array([-1.0, 0.0, 0.0]), 0.03)
    np.testing.assert_allclose(insertion.offset(0.04, 0.012), [-0.03, 0.0, 0.012])
    np.testing.assert_allclose(insertion.offset(0.02, 0.0), [-0.02, 0.0, 0.0])


def test_a_place_that_is_taken_is_refused_by_name() -> None:
    with pytest.raises(PackError, match="'target' overlaps that of 'east'"):
        chosen(EAST.moved((-0.02, 0, 0)))


def test_a_ray_that_only_touches_a_corner_misses() -> None:
    corner = np.array([1.0, -1.0]), np.array([2.0, 1.0])
    assert ray_to_rectangle(np.zeros(2), np.full(2, np.sqrt(0.5)), *corner) == np.inf


@settings(max_examples=60)
@given(boxes=grids(), data=st.data())
def test_on_its_way_in_a_box_meets_nothing(boxes: list[PlacedBox], data: st.DataObject) -> None:
    target = data.draw(st.sampled_from(boxes))
    others = [item for item in boxes if item is not target]
    insertion = choose_insertion(target, others, CONFIG, PALLET)
    for share in np.linspace(0.0, 1.0, 25):
        moved = target.moved(share * insertion.corridor * insertion.outward)
        assert not any(moved.overlaps(other) for other in others)


@given(
    x=st.floats(-2, 2), y=st.floats(-2, 2), side=st.sampled_from(sorted(SIDES)),
    width=st.floats(0.1, 1.0), depth=st.floats(0.1, 1.0),
)  # fmt: skip
def test_a_ray_ends_where_fine_steps_along_it_enter_the_rectangle(
    x: float, y: float, side: str, width: float, depth: float
) -> None:
    origin, outward = np.array([x, y]), np.array(SIDES[side]) / np.linalg.norm(SIDES[side])
    lower, upper = np.array([-width, -depth]), np.array([width, depth])
    steps = np.arange(0.0, 6.0, 0.005)
    points = origin + steps[:, None] * outward
    is_inside = np.all((points > lower) & (points < upper), axis=1)
    length = ray_to_rectangle(origin, outward, lower, upper)
    if np.any(is_inside):
        assert length == pytest.approx(steps[np.argmax(is_inside)], abs=0.0051)
    else:  # it misses, or cuts a corner between two steps
        assert length == np.inf or np.min(np.abs(np.abs(origin + length * outward) - upper)) < 0.0051
