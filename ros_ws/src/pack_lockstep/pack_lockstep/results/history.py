"""results/history.csv: success, time, force and error of every published result over time, and their plot."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

HISTORY, PLOT = "history.csv", "results_history.png"
COLUMNS = ("date", "version", "commit", "name", "success", "of", "time_s", "force_N", "error_mm")
QUANTITIES = {"time_s": "time [s]", "force_N": "force [N]", "error_mm": "largest error [mm]"}
DPI = 130


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
    """Draw each figure over the runs: a row a cell, a column a quantity, a line a result."""
    rows = read(folder)
    cells = list(dict.fromkeys(row["name"].partition("/")[0] for row in rows))
    figure = Figure(figsize=(14.0, 3.4 * max(1, len(cells))), layout="constrained")
    grid = figure.subplots(max(1, len(cells)), 1 + len(QUANTITIES), squeeze=False)
    for axes_of_cell, cell in zip(grid, cells, strict=False):
        own = [row for row in rows if row["name"].startswith(f"{cell}/")]
        _draw(axes_of_cell[0], own, "success", f"{cell}: success [%]")
        for axes, (column, label) in zip(axes_of_cell[1:], QUANTITIES.items(), strict=True):
            _draw(axes, own, column, label)
        axes_of_cell[0].legend(fontsize=6, frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DPI)


def _draw(axes: Axes, rows: Sequence[Mapping[str, str]], column: str, label: str) -> None:
    runs = list(dict.fromkeys(_run(row) for row in rows))
    for name in dict.fromkeys(row["name"] for row in rows):
        points = [(runs.index(_run(row)), row) for row in rows if row["name"] == name and row[column]]
        values = [
            100.0 * float(row["success"]) / float(row["of"]) if column == "success" else float(row[column])
            for _, row in points
        ]
        axes.plot([x for x, _ in points], values, marker="o", markersize=3, label=name.partition("/")[2])
    axes.set_title(label, fontsize=9)
    axes.set_xticks(range(len(runs)), runs, rotation=45, ha="right", fontsize=6)
    axes.grid(alpha=0.25)


def _run(row: Mapping[str, str]) -> str:
    """What stands below the axis: version and date."""
    return f"{row['version']}\n{row['date']}"


def _short(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
