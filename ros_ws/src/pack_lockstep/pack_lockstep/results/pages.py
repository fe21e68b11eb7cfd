"""Tables of README and the book, written from the published results.

A page has each table twice: as a template in an HTML comment, and below it the table that a reader sees.

    <!-- table
    | measure | here |
    |---|---|
    | packed | {packing.ideal.success} of {packing.ideal.scenes} |
    -->
    | measure | here |
    ...
    <!-- end of table -->

What stands in braces is looked up in the results, by cell, name and the keys of the summary, and written as
`str.format` does: `{packing.ideal.execution_time_s.mean:.2f}`. The line behind the table, with version and
date, is written from the results that the template names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Formatter
from typing import Any

from pack_core.errors import ConfigError
from pack_lockstep.results.published import PublishedResult

TABLE = re.compile(r"(<!-- table\n)(.*?)(\n-->\n)(.*?)(<!-- end of table -->)", re.DOTALL)
NONE = "–"
"""Stands where there is no figure."""


def pages(root: Path) -> list[Path]:
    """README and all pages of the book that have tables of results."""
    candidates = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]
    return [page for page in candidates if TABLE.search(page.read_text())]


def with_tables(text: str, results: Mapping[str, PublishedResult], version: str) -> str:
    """A page's text with its tables written anew.

    Args:
        text: the page.
        results: those that there are, by name.
        version: of the project; tables say of results of another one that they are of an earlier version.

    Raises:
        ConfigError: a template has a field that its result lacks.
    """

    def written(found: re.Match[str]) -> str:
        head, template, middle, _, end = found.groups()
        return f"{head}{template}{middle}{table(template, results, version)}{end}"

    return TABLE.sub(written, text)


def table(template: str, results: Mapping[str, PublishedResult], version: str) -> str:
    """A template's table and the line on what was measured when.

    Raises:
        ConfigError: a field does not exist in its result.
    """
    try:
        filled = Formatter().vformat(template, (), _Cells(results))
        used = dict.fromkeys(_names(template))
        line = measured({name: results.get(name) for name in used}, version)
    except (KeyError, AttributeError, ValueError, TypeError) as error:
        raise ConfigError(f"a table of results cannot be written: {error} in\n{template}") from error
    return f"{filled}\n\n{line}\n"


def measured(results: Mapping[str, PublishedResult | None], version: str) -> str:
    """A line on version and dates of the results, and on those that there are none of.

    Where versions differ, results are named; those of the version that most of them have are the others.
    """
    groups: dict[str, list[str]] = {}
    for name, result in results.items():
        groups.setdefault(_which(result, version), []).append(name)
    most = max(groups, key=lambda which: (which != "", len(groups[which])))
    parts = [
        _when(which, [result.date for name in names if (result := results[name])])
        + (f": {', '.join(names)}" if which != most else ": all others" if len(groups) > 1 else "")
        for which, names in sorted(groups.items(), key=lambda item: item[0] == most)
    ]
    text = "; ".join(parts)
    return f"*{text[:1].upper()}{text[1:]}.*"


def _which(result: PublishedResult | None, version: str) -> str:
    """Version of a result in words; empty where there is none."""
    if result is None:
        return ""
    if result.version != version:
        return f"the earlier version {result.version}"
    return f"version {result.version}, commit {result.commit[:8]}"


def _when(which: str, dates: Sequence[str]) -> str:
    if not which:
        return "not measured yet"
    first, last = min(dates), max(dates)
    return f"measured with {which}, {first}" + (f" to {last}" if last != first else "")


def _names(template: str) -> Iterator[str]:
    """Names of the results that a template has figures of."""
    for _, field, _, _ in Formatter().parse(template):
        if field:
            cell, name, *_ = re.split(r"[.\[]", field)
            yield f"{cell}/{name}"


class _Cells(dict[str, Any]):
    """Results by cell, for `str.format`."""

    def __init__(self, results: Mapping[str, PublishedResult]) -> None:
        self._results = results

    def __getitem__(self, cell: str) -> _Cell:
        return _Cell(cell, self._results)


class _Cell:
    """Results of a cell by name; of one that does not exist every figure is a dash."""

    def __init__(self, cell: str, results: Mapping[str, PublishedResult]) -> None:
        self._cell, self._results = cell, results

    def __getattr__(self, name: str) -> Any:
        result = self._results.get(f"{self._cell}/{name}")
        return _NoFigure() if result is None else _Figures(result.summary)


class _Figures:
    """A section of a summary, by attributes (`a.b`) or by keys (`a[b c]`)."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values

    def __getattr__(self, name: str) -> Any:
        if name not in self._values:
            raise AttributeError(f"no {name}; there are {', '.join(self._values)}")
        value = self._values[name]
        if isinstance(value, Mapping):
            return _Figures(value)
        return _NoFigure() if value is None else value

    __getitem__ = __getattr__


class _NoFigure:
    """Stands for a figure that was not measured, and for all that it would have."""

    def __getattr__(self, _name: str) -> _NoFigure:
        return self

    def __getitem__(self, _name: str) -> _NoFigure:
        return self

    def __format__(self, _spec: str) -> str:
        return NONE
