"""Tables of measures for terminals and reports, and the annotation that turns a measure into a row.

A measure is one field of a cell's dataclass of measures, annotated with its row. Nothing else lists it:

    drops: Annotated[int, MeasureText("drops", str, "boxes that the gripper lost")]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, get_type_hints

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@dataclass(frozen=True)
class Row:
    """One line of the table of a run's measures."""

    name: str
    value: str
    meaning: str


@dataclass(frozen=True)
class TextTable:
    """A table for terminals and reports; `note` is a sentence below or above it."""

    title: str
    note: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class MeasureText:
    """How a row shows a measure.

    Attributes:
        name: name of the row.
        text: turns the measure's value into text.
        meaning: explanation of the measure; a function of all measures where it depends on them.
    """

    name: str
    text: Callable[[Any], str]
    meaning: str | Callable[[Any], str]


def measure_rows(measures: DataclassInstance) -> tuple[Row, ...]:
    """The rows of all fields that are annotated with `MeasureText`, in the order of the fields."""
    hints = get_type_hints(type(measures), include_extras=True)
    return tuple(
        Row(text.name, text.text(getattr(measures, item.name)), _meaning(text, measures))
        for item in fields(measures)
        for text in getattr(hints[item.name], "__metadata__", ())
        if isinstance(text, MeasureText)
    )


def _meaning(text: MeasureText, measures: Any) -> str:
    return text.meaning if isinstance(text.meaning, str) else text.meaning(measures)


def yes_or_no(value: bool) -> str:
    """`yes` or `no` for a truth value."""
    return "yes" if value else "no"


def number(unit: str, digits: int = 2, factor: float = 1.0) -> Callable[[float], str]:
    """A function that formats a number, times a factor, with its unit; NaN (no value) becomes a dash."""
    return lambda value: "-" if value != value else f"{factor * value:.{digits}f} {unit}".strip()


def mean_and_max(unit: str, digits: int = 3) -> Callable[[tuple[float, float]], str]:
    """A function that formats a pair of mean and largest value with their unit."""
    return lambda pair: f"{pair[0]:.{digits}f}, {pair[1]:.{digits}f} {unit}"
