"""Reads orders from JSON: the result is an order that can be built, or an error that names every problem."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from pack_core.errors import ConfigError, OrderError
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_check import misfits_of, problems_of
from pack_core.palletizing.orders.support import SupportConfig
from pack_core.text.explanation import Lines, refusal
from pack_core.text.json_text import parse_json
from pack_core.text.known_keys import meant
from pack_core.text.reader import read_text
from pack_core.text.shown import listed, on_one_line, shown_value


def load_order(path: Path, cell: PalletizingCell | None = None) -> Order:
    """Read an order's file.

    Args:
        path: path of the file.
        cell: the cell that shall build the order; None: any cell.

    Raises:
        OrderError: the order cannot be read or built; the text has a line for every problem.
    """
    try:
        text = read_text(path)
    except ConfigError as error:
        raise OrderError(str(error)) from error
    return parse_order(text, str(path), cell=cell)


def parse_order(
    text: str, source: str, config: SupportConfig | None = None, *, cell: PalletizingCell | None = None
) -> Order:
    """Read an order from JSON text.

    Args:
        text: the order as JSON.
        source: where the text is from, for errors.
        config: the support that every box must have.
        cell: the cell that shall build the order; None: any cell.

    Raises:
        OrderError: the order cannot be read or built; the text has a line for every problem.
    """
    order = order_as_written(text, source)
    if problems := reasons_against(order, config or SupportConfig(), cell):
        raise OrderError(listed([f"{source}: {problem}" for problem in problems]))
    return order


def reasons_against(order: Order, config: SupportConfig, cell: PalletizingCell | None) -> list[str]:
    """Every reason why an order cannot be built, by this cell where one is given; empty where it can."""
    return [*problems_of(order, config), *([] if cell is None else misfits_of(order, cell))]


def order_as_written(text: str, source: str) -> Order:
    """An order whose keys and values are allowed, whether or not it can be built.

    Raises:
        OrderError: a key or value is not allowed; the text has a line for every problem.
    """
    try:
        data = parse_json(text, source)
    except ConfigError as error:
        raise OrderError(str(error)) from error
    if not isinstance(data, dict):
        raise OrderError(
            f"{source}: holds a {type(data).__name__}; allowed: an object with order_id, pallet and boxes"
        )
    try:
        return Order.model_validate(data)
    except ValidationError as error:
        lines = Lines(text)
        problems = [_explain(item, data, source, lines) for item in error.errors(include_url=False)]
        raise OrderError(listed(problems)) from error


def _explain(item: Any, data: dict[str, Any], source: str, lines: Lines) -> str:
    line = lines.of(item["loc"])
    place, keys = source if line is None else f"{source}, line {line}", [str(part) for part in item["loc"]]
    if keys[:1] == ["boxes"] and len(keys) > 1:
        place, keys = f"{place}: {_name_of(data['boxes'], int(keys[1]))}", keys[2:]
    key = on_one_line(".".join(keys))
    if item["type"] == "extra_forbidden":
        return f"{place}: key '{key}' is not known; {meant(Order, item['loc'])}"
    if item["type"] == "missing":
        return f"{place}: key '{key}' is missing"
    return refusal(place, key, item)


def _name_of(boxes: Any, index: int) -> str:
    entry = boxes[index]
    if isinstance(entry, dict) and isinstance(entry.get("id"), str):
        return f"box {shown_value(entry['id'])}"
    return f"box {index + 1} of the list"
