"""Tables of measures for terminals and reports, and the annotation that turns a measure into a row.

A measure is one field of a cell's dataclass of measures, annotated with its row. Nothing else lists it:

    drops: Annotated[int, MeasureText("drops", str, "boxes that the gripper lost")]
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
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


Columns = Sequence[tuple[str, Callable[[Any], str]]]
"""Head of each column, and what turns a study's summary into the cell below it."""


def row_a_study(title: str, note: str, columns: Columns, summaries: Mapping[str, Any]) -> TextTable:
    """A table with a row for each study, by its name."""
    rows = tuple((name, *(text(summary) for _, text in columns)) for name, summary in summaries.items())
    return TextTable(title, note, ("", *(head for head, _ in columns)), rows)


def column_a_study(
    title: str, note: str, rows: Iterable[tuple[str, Callable[[Any], str]]], summaries: Mapping[str, Any]
) -> TextTable:
    """A table with a column for each study, by its name: the name of each row, and the text of its cells."""
    lines = tuple((name, *(text(summary) for summary in summaries.values())) for name, text in rows)
    return TextTable(title, note, ("", *summaries), lines)


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
    """A function that formats a pair of mean and largest value with their unit; NaN becomes a dash."""
    return lambda pair: "-" if pair[0] != pair[0] else f"{pair[0]:.{digits}f}, {pair[1]:.{digits}f} {unit}"


def optional_number(value: float | None, digits: int = 2, factor: float = 1.0) -> str:
    """A number, times a factor; a dash for None and NaN (no value)."""
    return "-" if value is None or value != value else f"{factor * value:.{digits}f}"
