"""Figures of reports: written as PNG, in common colours."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from matplotlib.figure import Figure

INK, GREY, RED, GREEN, BLUE = "#20252b", "#9aa4ae", "#c03a2b", "#2f8a46", "#2b6cb0"


def write_figures(figures: Mapping[str, Figure], folder: Path, dpi: int = 130) -> list[Path]:
    """Write figures by their names into a folder, which is made, and return their paths in order."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {folder / f"{name}.png": figure for name, figure in figures.items()}
    for path, figure in paths.items():
        figure.savefig(path, dpi=dpi)
    return list(paths)
