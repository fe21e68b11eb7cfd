"""How full containers are over the time of their jobs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from pack_core.rotations import Array

Fills = Sequence[Sequence[float]]
"""Rows of one job: time [s], share of the base area, share of the volume."""


def plot_fills(jobs: Mapping[str, Sequence[Fills]], folder: Path) -> list[Path]:
    """Draw the covered share of the base over time, one line a job, one colour a study; makes the folder."""
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.subplots()
    for i, (name, fills) in enumerate(jobs.items()):
        for k, rows in enumerate(fills):
            times = [row[0] - rows[0][0] for row in rows]
            axes.step(
                times, [1e2 * row[1] for row in rows], where="post", color=f"C{i}", alpha=0.7, lw=1.2,
                label=name if k == 0 else None,
            )  # fmt: skip
    axes.set_xlabel("time [s]")
    axes.set_ylabel("base area covered [%]")
    axes.set_ylim(0.0, 100.0)
    axes.grid(alpha=0.3)
    if jobs:
        axes.legend(loc="lower right")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "fill.png"
    figure.savefig(path, dpi=120)
    return [path]


def plot_forces(times: Array, forces: Array, folder: Path) -> Path:
    """Draw the magnitude of the external force `(F,)` [N] over times `(F,)` [s]."""
    figure = Figure(figsize=(7.0, 2.4), layout="constrained")
    axes = figure.subplots()
    axes.plot(times - times[0], forces, lw=0.6)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("external force [N]")
    axes.grid(alpha=0.3)
    path = folder / "force.png"
    figure.savefig(path, dpi=120)
    return path
