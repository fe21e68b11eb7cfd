"""Orders that stand are refused where the cell has another pallet or its gripper would lose a box."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.errors import OrderError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order import OrderBox
from pack_core.palletizing.orders.order_check import GRAVITY, grips_of
from pack_core.palletizing.orders.order_file import load_order, parse_order
from pack_core.paths import config_path

CELL = palletizing_cell()
GRIP, A = CELL.grip, CELL.grip.carrying_acceleration
ORDERS = sorted(config_path("orders").glob("*.json"))
UPRIGHT, STOOD_UP = 0, 5
"""orient_id, with the bundling axis z."""


def one_box(weight: float = 5.0, orient_id: int = UPRIGHT, dims: tuple[float, ...] = (0.4, 0.3, 0.2)) -> Any:
    box = {"id": "a", "dims": dims, "weight": weight, "orient_id": orient_id, "bundling_axis": "z",
           "position": (0.1, 0.1, 0.0)}  # fmt: skip
    pallet = {"length": 1.2, "width": 0.8, "deck_height": 0.144}
    return {"order_id": "one", "pallet": pallet, "boxes": [box]}


def refusal(data: object) -> str:
    with pytest.raises(OrderError) as caught:
        parse_order(json.dumps(data), "an.json", cell=CELL)
    return str(caught.value)


@pytest.mark.parametrize("path", ORDERS, ids=lambda path: path.stem)
def test_the_cell_can_build_every_real_order(path: Path) -> None:
    assert len(load_order(path, CELL).boxes) == len(load_order(path).boxes)


@pytest.mark.parametrize(
    ("orient_id", "dims", "limit", "words"),
    [
        (
            UPRIGHT,
            (0.4, 0.3, 0.2),
            GRIP.coaxial_force / (GRAVITY + A),
            "above, make a coaxial force of 350.3 N",
        ),
        (UPRIGHT, (0.4, 0.4, 0.4), GRIP.moment / (0.2 * A), "from above, make a moment of 30.0 N m"),
        (STOOD_UP, (0.4, 0.3, 0.2), GRIP.shear_force / (GRAVITY + A), "side, make a shear force of 250.2 N"),
        (STOOD_UP, (0.4, 0.38, 0.3), GRIP.moment / (0.15 * (GRAVITY + A)), "side, make a moment of 30.0 N m"),
    ],
    ids=["pull", "swing", "shear", "bending"],
)
def test_a_box_is_refused_from_the_weight_on_that_passes_a_limit(
    orient_id: int, dims: tuple[float, ...], limit: float, words: str
) -> None:
    assert parse_order(json.dumps(one_box(0.999 * limit, orient_id, dims)), "an.json", cell=CELL)
    text = refusal(one_box(1.001 * limit, orient_id, dims))
    assert text.startswith(f"an.json: box 'a': {1.001 * limit:g} kg, held")
    assert words in text
    assert "config/cells/palletizing.yaml: grip." in text


def test_a_slender_box_that_is_stood_up_must_not_swing_too_far_under_the_pad() -> None:
    text = refusal(one_box(13.0, STOOD_UP, (0.6, 0.58, 0.2)))
    assert text == (
        "an.json: box 'a': 13 kg, stood up, make a moment of 30.2 N m; "
        "allowed: 30 N m (config/cells/palletizing.yaml: grip.moment)"
    )


def test_a_face_narrower_than_the_pad_is_refused() -> None:
    assert "its face is 0.1 m wide where it is held from above; allowed: 0.11 m" in refusal(
        one_box(dims=(0.2, 0.1, 0.1))
    )
    assert "its face is 0.1 m wide where it is stood up" in refusal(one_box(1.0, STOOD_UP, (0.2, 0.15, 0.1)))


def test_each_box_and_each_limit_is_told_of() -> None:
    data = one_box(50.0, STOOD_UP)
    data["boxes"].append({**data["boxes"][0], "id": "b", "position": (0.6, 0.1, 0.0)})
    lines = refusal(data).splitlines()
    assert [line.split("'")[1] for line in lines] == ["a"] * 3 + ["b"] * 3
    assert [line.rsplit("grip.")[1] for line in lines[:3]] == ["coaxial_force)", "shear_force)", "moment)"]


@pytest.mark.parametrize(("key", "value"), [("length", 1.0), ("width", 1.2), ("deck_height", 0.1)])
def test_another_pallet_than_the_cells_is_refused(key: str, value: float) -> None:
    data = one_box()
    data["pallet"][key] = value
    assert f"an.json: key 'pallet.{key}' is {value:g}; allowed: " in refusal(data)
    assert parse_order(json.dumps(data), "an.json").pallet.model_dump()[key] == value


@given(
    weight=st.floats(0.1, 100.0), factor=st.floats(1.0, 3.0), acceleration=st.floats(0.0, 20.0),
    orient_id=st.integers(0, 5),
)  # fmt: skip
def test_loads_grow_with_the_weight_and_at_rest_are_the_weight_alone(
    weight: float, factor: float, acceleration: float, orient_id: int
) -> None:
    light, heavy = (
        OrderBox.model_validate(one_box(mass, orient_id)["boxes"][0]) for mass in (weight, factor * weight)
    )
    for one, other in zip(grips_of(light, acceleration), grips_of(heavy, acceleration), strict=True):
        for key in ("coaxial", "shear", "moment"):
            assert getattr(other.load, key) == pytest.approx(factor * getattr(one.load, key))
    for grip in grips_of(light, 0.0):
        assert max(grip.load.coaxial, grip.load.shear) == pytest.approx(weight * GRAVITY)
        assert min(grip.load.coaxial, grip.load.shear) == 0.0
