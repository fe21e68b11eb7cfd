"""Lists of items from CSV and JSON, and what is said about wrong ones."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pack_core.errors import OrderError
from pack_core.palletizing.orders.item_list import load_items
from pack_core.paths import config_path

HEAD = "article,length,width,height,weight,quantity,this_side_up\n"


def written(folder: Path, text: str, name: str = "items.csv") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_rows_become_boxes_with_names_of_their_own_in_metres(tmp_path: Path) -> None:
    path = written(tmp_path, HEAD + "tea,400,300,200,5.5,2,yes\ncups,250,200,150,3,,\n")
    boxes = load_items(path, "mm")
    assert [box.id for box in boxes] == ["tea-1", "tea-2", "cups-3"]
    assert boxes[0].size == (0.4, 0.3, 0.2)
    assert [box.this_side_up for box in boxes] == [True, True, False]
    assert (boxes[2].weight, boxes[2].article) == (3.0, "cups")


def test_semicolons_and_other_orders_of_columns_are_read(tmp_path: Path) -> None:
    path = written(tmp_path, "weight;height;width;length;article\n5;0.2;0.3;0.4;tea\n")
    assert load_items(path)[0].size == (0.4, 0.3, 0.2)


def test_json_lists_and_objects_say_the_same(tmp_path: Path) -> None:
    rows = [{"article": "tea", "length": 0.4, "width": 0.3, "height": 0.2, "weight": 5, "quantity": 2}]
    one = load_items(written(tmp_path, json.dumps(rows), "one.json"))
    other = load_items(written(tmp_path, json.dumps({"items": rows}), "other.json"))
    assert one == other
    assert len(one) == 2


def test_an_orders_file_stands_for_its_boxes_without_their_places() -> None:
    boxes = load_items(config_path("orders", "order_05.json"))
    assert len(boxes) == 7
    assert boxes[0].size == (0.2, 0.59, 0.21)
    assert boxes[0].this_side_up


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("article,length\ntea,1\n", "line 1: no column width, height, weight; allowed"),
        (HEAD + "tea,0.4,0.3,minus,5,1,no\n", "line 2: 'height' is 'minus'; allowed"),
        (HEAD + "tea,0.4,0.3,0.2,5,0,no\n", "'quantity' is '0'"),
        (HEAD + "tea,0.4,0.3,,5,1,no\n", "line 2: 'height' is missing"),
        (HEAD + "tea,0.4,0.3,0.2,5,1,perhaps\n", "'this_side_up' is 'perhaps'; allowed: yes or no"),
        (HEAD + "tea,0.4,0.3,0.2,5,1,no,9\n", "line 2: more values than columns"),
        (HEAD + "tea,0.4,0.3,0.2,5,2000,no\n", "'quantity'"),
        (HEAD, "no items"),
        (
            HEAD + "tea,400,0.3,0.2,5,1,no\n",
            r"line 2: 'length' is 400 m; allowed: 0.01 to 3 m; .*--unit m, cm or mm",
        ),
        (HEAD + "tea,0.4,0.3,0.005,5,1,no\n", "line 2: 'height' is 0.005 m; allowed: 0.01 to 3 m"),
        (
            HEAD + "label,0.4,0.3,0.2,0.0005,1,no\n",
            "line 2: 'weight' is 0.0005 kg; allowed: 0.001 to 1000 kg",
        ),
        (HEAD + "tea,nan,0.3,0.2,5,1,no\n", "line 2: 'length' is 'nan'; allowed"),
        (
            HEAD + "A" * 64 + ",0.4,0.3,0.2,5,1,no\n",
            "line 2: 'article' is 'A.*; allowed: up to 62 characters",
        ),
        (
            "article,length,length,width,height,weight\ntea,1,1,1,1,1\n",
            "line 1: column length is given more than once",
        ),
        ("colour," + HEAD + "red,tea,0.4,0.3,0.2,5,1,no\n", "column 'colour' is not known; allowed: article"),
    ],
)
def test_what_is_wrong_is_told_with_its_line_and_what_is_allowed(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(OrderError, match=message):
        load_items(written(tmp_path, text))


def test_limits_are_told_in_the_lists_own_unit(tmp_path: Path) -> None:
    with pytest.raises(OrderError, match=r"'width' is 0.3 mm; allowed: 10 to 3000 mm; .* read in mm"):
        load_items(written(tmp_path, HEAD + "tea,400,0.3,200,5,1,no\n"), "mm")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_of_all_systems_are_read(tmp_path: Path, end: str) -> None:
    text = HEAD + "tea,0.4,0.3,0.2,5,2,no\ncups,0.3,0.3,0.2,5,1,no\n"
    (tmp_path / "items.csv").write_bytes(text.replace("\n", end).encode())
    assert [box.id for box in load_items(tmp_path / "items.csv")] == ["tea-1", "tea-2", "cups-3"]


def test_empty_columns_behind_the_last_one_are_passed_over(tmp_path: Path) -> None:
    rows = [line + ",," for line in (HEAD + "tea,0.4,0.3,0.2,5,2,no\n").splitlines()]
    assert len(load_items(written(tmp_path, "\n".join(rows)))) == 2


def test_a_key_given_twice_is_refused(tmp_path: Path) -> None:
    text = '[{"article": "tea", "length": 0.4, "length": 0.5, "width": 0.3, "height": 0.2, "weight": 5}]'
    with pytest.raises(OrderError, match="length"):
        load_items(written(tmp_path, text, "items.json"))


def test_all_wrong_rows_are_told_at_once(tmp_path: Path) -> None:
    with pytest.raises(OrderError, match=r"(?s)line 2.*line 3"):
        load_items(written(tmp_path, HEAD + "tea,-1,0.3,0.2,5,1,no\ntea,0.4,0,0.2,5,1,no\n"))


def test_what_may_stand_on_an_item_is_read_from_its_columns(tmp_path: Path) -> None:
    path = tmp_path / "items.csv"
    path.write_text(
        "article,length,width,height,weight,max_load,max_pressure,stackable\n"
        "a,0.4,0.3,0.2,5,12.5,2,yes\nb,0.4,0.3,0.2,5,,,\nc,0.4,0.3,0.2,5,9,,no\n"
    )
    found = [(item.max_load, item.max_pressure) for item in load_items(path)]
    assert found == [(12.5, 2.0), (None, None), (0.0, None)]
    path.write_text("article,length,width,height,weight,max_pressure\na,0.4,0.3,0.2,5,-2\n")
    with pytest.raises(OrderError, match="'max_pressure' is '-2'"):
        load_items(path)
