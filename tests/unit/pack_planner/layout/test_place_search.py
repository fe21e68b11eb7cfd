"""The compiled search for places against the checks of an order, place by place."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import Stack, stack_of
from pack_core.palletizing.orders.support import SupportConfig, support_of
from pack_core.palletizing.orders.tipping import TippingConfig, tipping_boxes
from pack_planner.layout.place_search import STEP, Needs, PlaceCosts, Room, costs_of, places_of, stands

ROOM = Room(*palletizing_cell().pallet.size, 1.0, 0.002)
SUPPORT = SupportConfig()


def random_stack(seed: int) -> tuple[Stack, list[PlacedBox]]:
    """Boxes let down one by one at places that are drawn, each carried, some of which may carry little."""
    rng, boxes = np.random.default_rng(seed), list[PlacedBox]()
    stack, _ = stack_of(boxes)
    for number in range(9):
        size = rng.choice([0.15, 0.25, 0.3, 0.4], 3)
        limits = {"max_load": 20.0} if rng.random() < 0.3 else {"max_pressure": 2.0}
        for p in rng.permutation(places_of(stack, size, ROOM)):
            box = PlacedBox(f"b{number}", p, size, float(rng.uniform(2, 12)), **limits)
            if support_of(box, boxes).problem(SUPPORT) is None:
                boxes.append(box)
                stack, _ = stack_of(boxes)
                break
    return stack, boxes


@pytest.mark.parametrize("seed", range(1000, 1003))
@pytest.mark.parametrize("push", [0.0, 0.25])
def test_a_place_is_taken_just_where_no_check_of_the_grown_stack_finds_a_new_fault(
    seed: int, push: float
) -> None:
    stack, boxes = random_stack(seed)
    tipping, size = TippingConfig(push=push), np.array([0.3, 0.25, 0.15])
    before = {*tipping_boxes(boxes, tipping), *overloaded_boxes(boxes)}
    judged = []
    for p in places_of(stack, size, ROOM):
        box = PlacedBox("new", p, size, 6.0)
        grown = [*boxes, box]
        faults = {*tipping_boxes(grown, tipping), *overloaded_boxes(grown)} - before
        is_fine = support_of(box, boxes).problem(SUPPORT) is None and not faults
        if before & _under(box, boxes):
            continue  # what tips or is overloaded already is not asked of this place alone
        lower = box.lower.copy()  # not read-only: as the search has it, for which this is compiled
        found = stands(stack, lower, box.upper, 6.0, Needs(SUPPORT.min_share, SUPPORT.min_margin, push))
        assert found == is_fine, (p, faults)
        judged.append(is_fine)
    assert any(judged)


def _under(box: PlacedBox, boxes: list[PlacedBox]) -> set[str]:
    """Names of all boxes that carry a box, directly or through others."""
    below = [other for other in boxes if box.rests_on(other)]
    return {other.id for other in below}.union(*(_under(other, boxes) for other in below))


def test_a_box_between_two_others_in_a_corner_touches_more_than_one_in_the_open() -> None:
    """A cube of edge a has five faces that can touch: base and sides; the top counts for nothing."""
    a = 0.2
    stack, _ = stack_of([PlacedBox("left", np.zeros(3), np.full(3, a), 1.0)])
    beside, alone = np.array([a + ROOM.gap, 0.0, 0.0]), np.array([0.5, 0.3, 0.0])
    costs = costs_of(stack, np.full(3, a), True, np.array([beside, alone]), ROOM, PlaceCosts(untouched=1.0))
    # Beside the other one it touches base, deck's edge and neighbour; in the open its base alone.
    assert costs == pytest.approx([1.0 - 3 / 5, 1.0 - 1 / 5])


def test_room_is_lost_over_a_box_on_which_nothing_may_stand() -> None:
    stack, _ = stack_of([])
    size, places = np.array([0.4, 0.3, 0.2]), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]])
    lost = 0.4 * 0.3 * (ROOM.highest - places[:, 2] - 0.2)
    costs = PlaceCosts(dead=60.0)
    np.testing.assert_allclose(costs_of(stack, size, False, places, ROOM, costs), 60.0 * lost)
    np.testing.assert_array_equal(costs_of(stack, size, True, places, ROOM, costs), 0.0)


@pytest.mark.parametrize("seed", range(10))
def test_places_beside_a_box_that_stands_anywhere_are_beside_it(seed: int) -> None:
    """On all four sides, and at the far border, on the ground."""
    rng = np.random.default_rng(seed)
    p, size = np.array([*rng.uniform(0.35, 0.4, 2), 0.0]), rng.uniform(0.2, 0.3, 3)
    stack, _ = stack_of([PlacedBox("box", p, size, 1.0)])
    places = places_of(stack, size, ROOM)
    on_ground = places[places[:, 2] == 0.0]
    for k, length in enumerate((ROOM.length, ROOM.width)):
        wished = p[k] + size[k] + ROOM.gap, p[k] - ROOM.gap - size[k], length - size[k]
        for at in (at for at in wished if 0.0 <= at <= length - size[k]):
            assert np.abs(on_ground[:, k] - at).min() < STEP
