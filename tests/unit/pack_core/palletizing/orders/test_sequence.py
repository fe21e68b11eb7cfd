"""Re-sequencing keeps what a box needs under it, and keeps wells shallow."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pack_core.palletizing.orders.layout_plan import resequence
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.support import SupportConfig, unstable_boxes
from pack_core.paths import config_path

RISE = 0.12
ORDERS = sorted(config_path("orders").glob("*.json"))


def block(name: str, x: float, height: float, z: float = 0.0) -> PlacedBox:
    return PlacedBox(name, np.array([x, 0.0, z]), np.array([0.3, 0.3, height]), 1.0)


def names(boxes: tuple[PlacedBox, ...]) -> list[str]:
    return [item.id for item in boxes]


@pytest.mark.parametrize("path", ORDERS, ids=lambda path: path.stem)
def test_every_prefix_of_an_order_stands_and_leaves_the_way_down_free(path: Path) -> None:
    boxes = load_order(path).placed
    sequence = resequence(boxes, RISE)
    assert sorted(names(sequence)) == sorted(names(boxes))
    for k, item in enumerate(sequence):
        assert not any(earlier.is_over(item) for earlier in sequence[:k])
        assert unstable_boxes(sequence[: k + 1], SupportConfig()) == {}


def test_low_boxes_come_before_their_tall_neighbour() -> None:
    boxes = (block("tall", 0.0, 0.6), block("low", 0.3, 0.1), block("upper", 0.3, 0.1, z=0.1))
    assert names(resequence(boxes, RISE)) == ["low", "upper", "tall"]


def test_boxes_within_the_rise_keep_their_sequence() -> None:
    boxes = (block("b", 0.0, 0.11), block("a", 0.3, 0.05), block("c", 0.6, 0.10))
    assert names(resequence(boxes, RISE)) == ["b", "a", "c"]


def test_a_box_given_before_what_carries_it_comes_after() -> None:
    boxes = (block("upper", 0.0, 0.1, z=0.1), block("lower", 0.0, 0.1))
    assert names(resequence(boxes, RISE)) == ["lower", "upper"]


def test_no_well_is_deeper_than_in_the_given_sequence() -> None:
    deeper = []
    for path in ORDERS:
        boxes = load_order(path).placed
        if deepest_well(resequence(boxes, RISE)) > deepest_well(boxes) + 1e-9:
            deeper.append(path.stem)
    assert deeper == []


def deepest_well(sequence: tuple[PlacedBox, ...]) -> float:
    """How far a box's top ends up below that of an earlier neighbour within 0.1 m [m]."""
    depth = 0.0
    for k, item in enumerate(sequence):
        for earlier in sequence[:k]:
            if np.all(item.clearance(earlier)[:2] < 0.1):
                depth = max(depth, float(earlier.upper[2] - item.upper[2]))
    return depth
