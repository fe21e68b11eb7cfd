"""Orders beyond the limits are refused in words, and the check of the largest takes a few seconds."""

import json
import time
from collections.abc import Callable
from typing import Any

import pytest

from pack_core.errors import OrderError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order_file import load_order, parse_order
from pack_core.paths import config_path
from pack_core.text.limits import MOST_BOXES

EDGE = 0.11
"""Of the smallest box whose face the gripper's smallest seal fits [m]."""


def order_of(count: int, place: Callable[[int], list[float]], **box: Any) -> str:
    pallet = palletizing_cell().pallet
    entry = {"dims": [EDGE] * 3, "weight": 1.0, "orient_id": 0, "bundling_axis": "z", **box}
    boxes = [{"id": f"b{k}", **entry, "position": place(k)} for k in range(count)]
    length, width = pallet.size
    sizes = {"length": length, "width": width, "deck_height": pallet.deck_height}
    return json.dumps({"order_id": "many", "pallet": sizes, "boxes": boxes})


def in_a_grid(k: int) -> list[float]:
    nx, ny = (int(side / EDGE + 1e-9) for side in palletizing_cell().pallet.size)
    return [EDGE * (k % nx), EDGE * (k // nx % ny), EDGE * (k // (nx * ny))]


def test_the_largest_order_is_checked_in_five_seconds() -> None:
    text, start = order_of(MOST_BOXES, in_a_grid), time.process_time()
    assert len(parse_order(text, "o", cell=palletizing_cell()).boxes) == MOST_BOXES
    assert time.process_time() - start < 5.0


def test_a_thousand_boxes_in_one_place_are_refused_in_five_seconds() -> None:
    text, start = order_of(MOST_BOXES, lambda _: [0.0, 0.0, 0.0]), time.process_time()
    with pytest.raises(OrderError) as caught:
        parse_order(text, "o", cell=palletizing_cell())
    assert time.process_time() - start < 5.0
    assert len(str(caught.value).splitlines()) == 21


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (order_of(MOST_BOXES + 1, in_a_grid), "at most 1000 items"),
        (order_of(24, lambda k: [0.0, 0.0, EDGE * k]), "z 0 to 2.5"),
        (order_of(1, in_a_grid, dims=[0.2, 0.2, 0.001]), "greater than or equal to 0.01"),
        (order_of(1, in_a_grid, weight=1e-16), "greater than or equal to 0.001"),
        (order_of(1, in_a_grid, weight="1.0"), "a number, not a text"),
        (order_of(1, in_a_grid, id="\x1b[2J"), "'\\x1b[2J'"),
        (order_of(1, in_a_grid, id="a\nb"), "'a\\nb'"),
        (order_of(1, in_a_grid, id="<b>"), "key 'id' is '<b>'"),
        (order_of(1, in_a_grid, id="$x$"), "key 'id' is '$x$'"),
        (order_of(1, in_a_grid, id="../x"), "key 'id' is '../x'"),
        (order_of(1, in_a_grid, id="a" * 100_000), "at most 64 characters"),
        (order_of(1, in_a_grid).replace('"weight"', '"id": "b", "weight"'), "key 'id' is given twice"),
        (order_of(1, in_a_grid).replace("1.0", "9" * 400), "has 400 digits"),
    ],
)
def test_what_is_beyond_the_limits_is_named(text: str, words: str) -> None:
    with pytest.raises(OrderError) as caught:
        parse_order(text, "o", cell=palletizing_cell())
    assert words in str(caught.value)
    assert all(line.isprintable() and len(line) < 400 for line in str(caught.value).splitlines())


@pytest.mark.parametrize("name", ["00102400-4", "Box 3 (left)", "A/12", "Größe #4", "7622210449283", "x:y+z"])
def test_names_as_warehouses_give_them_are_allowed(name: str) -> None:
    assert parse_order(order_of(1, in_a_grid, id=name), "o").boxes[0].id == name


def test_the_shipped_orders_pass() -> None:
    paths = sorted(config_path("orders").glob("*.json"))
    assert len(paths) == 25
    assert all(load_order(path, palletizing_cell()).boxes for path in paths)
