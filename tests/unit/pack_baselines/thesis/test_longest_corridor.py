"""Eq. 6.5 as printed: of the admissible sides the one with the longest corridor."""

import numpy as np
import pytest

from pack_baselines.thesis.longest_corridor import longest_corridor
from pack_core.palletizing.orders.layout_plan import Insertion
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_planner.layout.insertion_direction import InsertionConfig, choose_insertion
from unit.pack_planner.layout.blocks import PALLET

CONFIG = InsertionConfig(inflation=0.020, reach=np.inf, min_corridor=1e-6)


def box(name: str, x: float, y: float, length: float = 0.2, width: float = 0.2) -> PlacedBox:
    return PlacedBox(name, np.array([x, y, 0.0]), np.array([length, width, 0.2]), 5.0)


TARGET = box("target", 0.2, 0.2)
WEST, SOUTH = box("west", 0.0, 0.2, 0.19), box("south", 0.2, 0.0, width=0.19)


def chosen(*placed: PlacedBox) -> Insertion:
    return longest_corridor(TARGET, placed, CONFIG, PALLET)


def test_without_a_neighbour_the_box_comes_straight_down() -> None:
    assert chosen() == chosen(box("far", 0.9, 0.5))
    assert chosen().direction == "Center"


def test_the_corridor_ends_at_the_pallets_border() -> None:
    """From the middle at (0.3, 0.3) it is 0.9 m to the border in the east."""
    found = chosen(WEST)
    assert found.direction == "East"
    assert found.corridor == pytest.approx(0.9)


def test_a_long_corridor_wins_over_one_that_opens_more_gaps() -> None:
    """A box in the northeast leaves little room there; both gaps open that way, one of them to the north."""
    blocker = box("northeast", 0.47, 0.47)
    shipped = choose_insertion(TARGET, [WEST, SOUTH, blocker], CONFIG, PALLET)
    printed = chosen(WEST, SOUTH, blocker)
    assert shipped.direction == "Northeast"
    assert printed.direction in ("North", "East")
    assert printed.corridor > shipped.corridor


def test_a_side_that_closes_a_gap_is_not_admissible() -> None:
    assert chosen(WEST, SOUTH).direction not in ("West", "South", "Northwest", "Southeast", "Southwest")


def test_a_box_amid_four_comes_straight_down() -> None:
    east, north = box("east", 0.41, 0.2), box("north", 0.2, 0.41)
    assert chosen(WEST, SOUTH, east, north).direction == "Center"
