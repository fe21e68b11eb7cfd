"""Tables of measures, for terminals and reports."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    value: str
    meaning: str


@dataclass(frozen=True)
class TextTable:
    """A table for terminals and reports."""

    title: str
    note: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
