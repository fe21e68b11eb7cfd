"""Orders that can be built load; everything else is refused in words that name file, box and key."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.errors import OrderError
from pack_core.palletizing.orders.order_file import load_order, parse_order
from pack_core.paths import config_path

ORDERS = sorted(config_path("orders").glob("*.json"))
STRESS = sorted(config_path("orders", "stress").glob("*.json"))
UNSTABLE = {
    "order_01.json": {"00104636-5", "00111275-7"},
    "order_02.json": {"00107768-4", "00104984-10"},
    "order_03.json": {"00101017-8", "00103919-9"},
    "order_04.json": {"00102099-13", "00112211-14", "00110106-15"},
}


def example() -> Any:
    return json.loads(ORDERS[2].read_text())


def refusal(data: object) -> str:
    with pytest.raises(OrderError) as caught:
        parse_order(json.dumps(data), "an.json")
    return str(caught.value)


def test_all_25_orders_load_with_their_206_boxes() -> None:
    orders = [load_order(path) for path in ORDERS]
    assert len(orders) == 25
    assert sum(len(order.boxes) for order in orders) == 206
    assert [len(order.placed) for order in orders] == [len(order.boxes) for order in orders]


@pytest.mark.parametrize("path", STRESS, ids=lambda path: path.stem)
def test_unstable_plans_are_refused_with_their_unstable_boxes_named(path: Path) -> None:
    with pytest.raises(OrderError) as caught:
        load_order(path)
    lines = str(caught.value).splitlines()
    assert {line.split("'")[1] for line in lines} == UNSTABLE[path.name]
    assert all("of its base is carried; allowed: at least 70%" in line for line in lines)


def change(key: str, value: object) -> Callable[[Any], None]:
    """Changes a key of the second box."""
    return lambda order: order["boxes"][1].__setitem__(key, value)


BOX = "box '00101323-5': "
REFUSALS: list[tuple[Callable[[Any], None], str]] = [
    (change("id", "00102400-4"), "an.json: box '00102400-4': key 'id' is given 2 times; allowed: once"),
    (change("dims", [0.585, -0.39, 0.22]), BOX + "key 'dims.1' is -0.39; allowed: greater"),
    (change("dims", [0.585, 0.39, float("nan")]), BOX + "key 'dims.2' is nan; allowed: a finite number"),
    (change("dims", [0.39, 0.585, 0.22]), BOX + "dims are [0.39, 0.585, 0.22]; allowed: d_x >= d_y >= d_z"),
    (change("dims", "large"), BOX + "key 'dims' is 'large'; allowed:"),
    (change("weight", 0), BOX + "key 'weight' is 0; allowed: greater than or equal to 0.001"),
    (change("weight", True), BOX + "key 'weight' is True; allowed:"),
    (change("orient_id", 6), BOX + "key 'orient_id' is 6; allowed: 0, 1, 2, 3, 4 or 5"),
    (change("bundling_axis", "x"), BOX + "key 'bundling_axis' is 'x'; allowed: 'z' or 'y'"),
    (change("colour", "red"), BOX + "key 'colour' is not known"),
    (change("handling", "flip"), BOX + "key 'handling' is 'flip'; orient_id 0 and bundling"),
    (change("placed_dims", [0.39, 0.585, 0.22]), BOX + "key 'placed_dims' is [0.39, 0.585, 0.22]; dims"),
    (change("seq", 3), BOX + "key 'seq' is 3; it stands at place 2"),
    (change("position", [0.315, 0.0, 0.0]), BOX + "key 'position' makes it overlap box '00102400-4' by 10"),
    (change("position", [0.7, 0.0, 0.0]), BOX + "key 'position' is (0.700, 0.000, 0.000), it ends at (1.2"),
    (change("position", [0.325, 0.0, 0.3]), BOX + "0.0% of its base is carried; allowed: at least 70%"),
    (change("position", [0.1, 0.05, 0.195]), BOX + "31.6% of its base is carried"),
    (lambda order: order["boxes"].__setitem__(1, 7), "an.json, line 1: box 2 of the list is 7; allowed"),
    (lambda order: order["boxes"][1].pop("id"), "an.json, line 1: box 2 of the list: key 'id' is missing"),
    (lambda order: order["boxes"].clear(), "an.json: key 'boxes' is empty; allowed: one box or more"),
    (lambda order: order.pop("pallet"), "an.json: key 'pallet' is missing"),
    (lambda order: order["units"].update(length="mm"), "an.json, line 1: key 'units.length' is 'mm'; allow"),
    (lambda order: order.update(total_boxes=3), "an.json: key 'total_boxes' is 3; its boxes give 2"),
    (lambda order: order.update(total_weight=17.0), "an.json: key 'total_weight' is 17; its boxes give 16"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("spoil", "words"), REFUSALS, ids=lambda value: value if isinstance(value, str) else ""
)
def test_a_wrong_order_is_refused_in_words(spoil: Callable[[Any], None], words: str) -> None:
    order = example()
    spoil(order)
    if "stack_height" not in words:
        order.pop("stack_height")
    assert words in refusal(order)


def test_every_problem_is_told_at_once() -> None:
    order = example()
    change("orient_id", 9)(order)
    change("weight", -1)(order)
    order["boxes"][0]["id"] = ""
    assert len(refusal(order).splitlines()) == 3


@pytest.mark.parametrize("text", ["", "{", "[]", "3", '"order"', "[" * 100_000, "\x00", "NaN"])
def test_text_that_is_no_order_is_refused(text: str) -> None:
    with pytest.raises(OrderError, match=r"^an\.json[:,] "):
        parse_order(text, "an.json")


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe{}")
    for name, words in [
        ("none.json", "no such file"),
        ("", "Is a directory"),
        ("binary.json", "no text in UTF-8"),
    ]:
        with pytest.raises(OrderError, match=words):
            load_order(tmp_path / name)


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@given(key=st.sampled_from(sorted(example()["boxes"][0])), value=JSON)
def test_whatever_a_box_holds_nothing_but_an_order_error_escapes(key: str, value: object) -> None:
    order = example()
    order["boxes"][0][key] = value
    assert has_boxes_or_is_refused(order)


@given(key=st.sampled_from(sorted(example())), value=JSON)
def test_whatever_an_order_holds_nothing_but_an_order_error_escapes(key: str, value: object) -> None:
    assert has_boxes_or_is_refused({**example(), key: value})


def has_boxes_or_is_refused(data: object) -> bool:
    try:
        return bool(parse_order(json.dumps(data), "an.json").boxes)
    except OrderError:
        return True
