"""A list of items that are to go on a pallet, without places: size, weight and quantity, from CSV or JSON."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, field_validator

from pack_core.config import Config
from pack_core.errors import ConfigError, OrderError
from pack_core.palletizing.orders.handling import turns_of
from pack_core.palletizing.orders.order import (
    EDGE_LIMITS,
    MASS_LIMITS,
    Dims,
    Mass,
    MaxLoad,
    MaxPressure,
    Order,
    OrderBox,
)
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Array
from pack_core.text.explanation import allowed_words
from pack_core.text.json_text import parse_json
from pack_core.text.limits import MOST_BOXES, MOST_CHARACTERS_OF_NAME, ArticleName
from pack_core.text.reader import read_text
from pack_core.text.shown import listed, shown_value

Unit = Literal["m", "cm", "mm"]
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""In a unit of lengths."""
NEEDED = ("article", "length", "width", "height", "weight")
COLUMNS = (*NEEDED, "quantity", "this_side_up", "max_load", "max_pressure", "stackable")
YES, NO = ("yes", "true", "1"), ("no", "false", "0", "")


Finite = Annotated[float, Field(allow_inf_nan=False)]
"""A number, also as a text; what an order allows of it is said by `Item`."""


class ListedItem(Config):
    """A row of the list: boxes of one article.

    Its edges are in the list's unit of length; `height` is upright where `this_side_up` is set.
    """

    article: ArticleName
    length: Finite
    width: Finite
    height: Finite
    weight: Finite = Field(description="of one box [kg]")
    quantity: int = Field(1, ge=1, le=MOST_BOXES)
    this_side_up: bool = Field(False, description="whether its height must stay upright")
    max_load: Finite | None = Field(None, ge=0.0, le=1e5, description="what may stand on one box [kg]")
    max_pressure: Finite | None = Field(None, gt=0.0, le=1e5, description="on a box's top [kPa]")
    stackable: bool = Field(True, description="whether anything at all may stand on it")

    @field_validator("this_side_up", "stackable", mode="before")
    @classmethod
    def _yes_or_no(cls, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        word = value.strip().lower()
        if word not in YES + NO:
            raise ValueError(f"yes or no (also {', '.join((*YES[1:], *NO[1:3]))})")
        return word in YES


class Item(Config):
    """One box of the list, with the limits that an order has.

    Attributes:
        id: name, once in the list: the article and a number.
        article: what it is.
        size: length, width and height [m], rounded to the millimetre.
        weight: [kg].
        this_side_up: whether its height must stay upright.
        max_load: what may stand on it [kg]; None: anything.
        max_pressure: largest pressure on its top [kPa]; None: any.
    """

    id: ArticleName
    article: str
    size: Dims
    weight: Mass
    this_side_up: bool
    max_load: MaxLoad | None = None
    max_pressure: MaxPressure | None = None


def placed_item(item: Item, lower: Array, size: Array) -> PlacedBox:
    """An item at a place, with what may stand on it; `lower` and `size` as `PlacedBox` has them."""
    limits = (np.inf if limit is None else limit for limit in (item.max_load, item.max_pressure))
    return PlacedBox(item.id, lower, size, item.weight, *limits)


def order_box(item: Item, placed: PlacedBox) -> OrderBox:
    """An item at its place, as an order has it: with the turn that gives it the extents it has there."""
    turns = turns_of(item.size, this_side_up=False)
    turn = min(turns, key=lambda turn: float(np.abs(np.array(turn.extents) - placed.size).max()))
    d_x, d_y, d_z = sorted(item.size, reverse=True)
    x, y, z = (float(value) for value in placed.lower)
    return OrderBox(
        id=item.id, dims=(d_x, d_y, d_z), weight=item.weight, orient_id=turn.orient_id,
        bundling_axis=turn.bundling_axis, position=(x, y, z), article=item.article,
        this_side_up=item.this_side_up, max_load=item.max_load, max_pressure=item.max_pressure,
    )  # fmt: skip


def load_items(path: Path, unit: Unit = "m") -> tuple[Item, ...]:
    """Read a list of items from a file that ends with .csv or .json.

    Args:
        path: the file. CSV has a line with the names of the columns first; JSON is a list of objects with
            the same names, or an object that has it as `items`. An order's file stands for its boxes, and
            its places are not looked at.
        unit: of all lengths in the file.

    Raises:
        OrderError: it cannot be read; the text has a line for every problem.
    """
    try:
        text = read_text(path)
        if path.suffix.lower() == ".json" and _is_order(parse_json(text, str(path))):
            # Here: checks of orders load a compiler, 100 MB that a simulator which reads lists does without.
            from pack_core.palletizing.orders.order_file import order_as_written

            return _items_of_order(order_as_written(text, str(path)))
        rows = _rows_of_json(text, path) if path.suffix.lower() == ".json" else _rows_of_csv(text, path)
    except ConfigError as error:
        raise OrderError(str(error)) from error
    problems: list[str] = []
    items: list[Item] = []
    for place, values in rows:
        try:
            row = ListedItem.model_validate(values)
        except ValidationError as error:
            problems += [_explained(f"{path}, {place}", item) for item in error.errors(include_url=False)]
            continue
        try:
            items += [_box(row, len(items) + number, METRES[unit]) for number in range(1, row.quantity + 1)]
        except ValidationError as error:
            problems += [
                f"{path}, {place}: {_refused(row, item, unit)}" for item in error.errors(include_url=False)
            ]
    if not problems and not items:
        problems.append(f"{path}: no items; allowed: one or more, with {', '.join(NEEDED)}")
    if problems:
        raise OrderError(listed(problems))
    if len(items) > MOST_BOXES:
        raise OrderError(f"{path}: {len(items)} boxes; allowed: up to {MOST_BOXES} in an order")
    return tuple(items)


def _is_order(data: Any) -> bool:
    return isinstance(data, dict) and "boxes" in data


def _items_of_order(order: Order) -> tuple[Item, ...]:
    """The boxes of an order, each with the edge that is upright in the order as its height."""
    return tuple(
        Item(
            id=box.id, article=box.article, size=box.turn.extents, weight=box.weight,
            this_side_up=bool(box.this_side_up), max_load=box.max_load, max_pressure=box.max_pressure,
        )
        for box in order.boxes
    )  # fmt: skip


def _box(row: ListedItem, number: int, metres: float) -> Item:
    """A box of a row, the list's box of this number; raises ValidationError where no order may have it."""
    length, width, height = (round(metres * edge, 3) for edge in (row.length, row.width, row.height))
    return Item(
        id=f"{row.article}-{number}", article=row.article, size=(length, width, height), weight=row.weight,
        this_side_up=row.this_side_up, max_load=row.max_load if row.stackable else 0.0,
        max_pressure=row.max_pressure,
    )  # fmt: skip


def _refused(row: ListedItem, problem: Any, unit: Unit) -> str:
    """What an order does not allow of a row, in the list's own columns and unit."""
    field, *rest = problem["loc"]
    if field == "id":
        number = problem["input"].removeprefix(row.article)
        longest = MOST_CHARACTERS_OF_NAME - len(number)
        return (
            f"'article' is {shown_value(row.article)}; allowed: up to {longest} characters, as '{number}' "
            "follows it in the name of a box"
        )
    column = COLUMNS[1 + rest[0]] if field == "size" else field
    scale, name = (METRES[unit], unit) if field == "size" else (1.0, "kg")
    least, most = EDGE_LIMITS if field == "size" else MASS_LIMITS
    hint = f"; lengths are read in {unit} (--unit m, cm or mm)" if field == "size" else ""
    allowed = f"{least / scale:g} to {most / scale:g} {name}"
    return f"'{column}' is {getattr(row, column):g} {name}; allowed: {allowed}{hint}"


def _rows_of_csv(text: str, path: Path) -> list[tuple[str, dict[str, Any]]]:
    try:
        delimiter = csv.Sniffer().sniff((text.splitlines() or [""])[0], ",;\t").delimiter
    except csv.Error:
        delimiter = ","
    # Without `newline` the line ends of Windows and of old Macs would not be those of rows.
    reader = csv.DictReader(io.StringIO(text, newline=None), delimiter=delimiter, skipinitialspace=True)
    names = [(name or "").strip() for name in reader.fieldnames or ()]
    missing = [name for name in NEEDED if name not in names]
    if missing:
        raise ConfigError(
            f"{path}, line 1: no column {', '.join(missing)}; allowed: the first line names the columns "
            f"{', '.join(COLUMNS)}, of which those behind {NEEDED[-1]} may be left out"
        )
    if twice := sorted({name for name in names if name and names.count(name) > 1}):
        raise ConfigError(
            f"{path}, line 1: column {', '.join(twice)} is given more than once; allowed: each name once"
        )
    reader.fieldnames = names
    rows = []
    try:
        for row in reader:
            if None in row:
                raise ConfigError(
                    f"{path}, line {reader.line_num}: more values than columns; allowed: {len(names)}"
                )
            # An empty cell counts as left out, so that a default is used or the column is named as missing.
            rows.append((f"line {reader.line_num}", {key: value for key, value in row.items() if value}))
    except csv.Error as error:
        raise ConfigError(f"{path}, line {reader.line_num}: {error}") from error
    return rows


def _rows_of_json(text: str, path: Path) -> list[tuple[str, Any]]:
    data = parse_json(text, str(path))
    if isinstance(data, dict):
        data = data.get("items")
    if not isinstance(data, list):
        raise ConfigError(f"{path}: allowed: a list of items, or an object that has one as `items`")
    return [(f"item {place}", values) for place, values in enumerate(data, start=1)]


def _explained(place: str, problem: Any) -> str:
    key = ".".join(str(part) for part in problem["loc"])
    if problem["type"] == "extra_forbidden":
        return f"{place}: column '{key}' is not known; allowed: {', '.join(COLUMNS)}"
    if problem["type"] == "missing":
        return f"{place}: '{key}' is missing"
    return f"{place}: '{key}' is {shown_value(problem['input'])}; allowed: {allowed_words(problem)}"
