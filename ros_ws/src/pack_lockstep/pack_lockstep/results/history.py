"""results/history.csv: success, time, force and error of every published result over time, and their plot."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import Any

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

HISTORY, PLOT = "history.csv", "results_history.png"
COLUMNS = ("date", "version", "commit", "name", "success", "of", "time_s", "force_N", "error_mm")
QUANTITIES = {
    "success": "success [%]",
    "time_s": "time [s]",
    "force_N": "force [N]",
    "error_mm": "largest error [mm]",
}
DPI = 130
"""Of the plot's pixels, in an inch."""


def append(folder: Path, row: Mapping[str, Any]) -> None:
    """Add a line to the history; columns that the row lacks stay empty."""
    path = folder / HISTORY
    is_new = not path.is_file()
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        if is_new:
            writer.writeheader()
        writer.writerow({column: _short(row.get(column)) for column in COLUMNS})


def read(folder: Path) -> list[dict[str, str]]:
    """The lines of the history, oldest first; none if there is no file."""
    path = folder / HISTORY
    if not path.is_file():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write_plot(folder: Path, path: Path) -> None:
    """Draw each figure over the versions: a row a cell, a column a quantity, a line a result.

    Of the runs of a result with one version the last counts.
    """
    rows = read(folder)
    cells = list(dict.fromkeys(row["name"].partition("/")[0] for row in rows))
    figure = Figure(figsize=(15.0, 3.6 * max(1, len(cells))), layout="constrained")
    parts: Sequence[SubFigure] = figure.subfigures(max(1, len(cells)), 1, squeeze=False)[:, 0].tolist()
    for part, cell in zip(parts, cells, strict=False):
        own = [row for row in rows if row["name"].startswith(f"{cell}/")]
        there = [column for column in QUANTITIES if any(row[column] for row in own)]
        all_axes: Sequence[Axes] = part.subplots(1, len(there), squeeze=False)[0].tolist()
        for axes, column in zip(all_axes, there, strict=True):
            _draw(axes, own, column)
        part.suptitle(cell)
        lines, names = all_axes[0].get_legend_handles_labels()
        part.legend(lines, names, loc="outside right upper", fontsize=7, frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DPI)


def _draw(axes: Axes, rows: Sequence[Mapping[str, str]], column: str) -> None:
    versions = list(dict.fromkeys(row["version"] for row in rows))
    colours = colormaps["tab20"].colors  # type: ignore[attr-defined]  # a list of twenty colours
    names = list(dict.fromkeys(row["name"] for row in rows))
    for name, colour in zip(names, cycle(colours), strict=False):
        values = {row["version"]: _value(row, column) for row in rows if row["name"] == name and row[column]}
        at = [versions.index(version) for version in values]
        label = name.partition("/")[2]
        axes.plot(at, list(values.values()), marker="o", markersize=4, color=colour, label=label)
    axes.set_title(QUANTITIES[column], fontsize=9)
    axes.set_xticks(range(len(versions)), versions, fontsize=8)
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.25)


def _value(row: Mapping[str, str], column: str) -> float:
    return 100.0 * float(row["success"]) / float(row["of"]) if column == "success" else float(row[column])


def _short(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
