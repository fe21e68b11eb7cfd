"""How full containers are over the time of their jobs, and the force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from pack_core.rotations import Array

Fills = Sequence[Sequence[float]]
"""Rows of one job: time [s], share of the base area, share of the volume."""
DPI = 120
"""Of the plots' pixels, in an inch."""


def draw_fills(jobs: Mapping[str, Sequence[Fills]]) -> Figure:
    """The covered share of the base over time, one line a job, one colour a study."""
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.subplots()
    for i, (name, fills) in enumerate(jobs.items()):
        for k, rows in enumerate(fills):
            times = [row[0] - rows[0][0] for row in rows]
            axes.step(
                times, [1e2 * row[1] for row in rows], where="post", color=f"C{i}", alpha=0.7, lw=1.2,
                label=name if k == 0 else None,
            )  # fmt: skip
    axes.set(xlabel="time [s]", ylabel="base area covered [%]", ylim=(0.0, 100.0))
    axes.grid(alpha=0.3)
    if jobs:
        axes.legend(loc="lower right")
    return figure


def draw_forces(times: Array, forces: Array) -> Figure:
    """The magnitude of the external force `(F,)` [N] over times `(F,)` [s]."""
    figure = Figure(figsize=(7.0, 2.4), layout="constrained")
    axes = figure.subplots()
    axes.plot(times - times[0], forces, lw=0.6)
    axes.set(xlabel="time [s]", ylabel="external force [N]")
    axes.grid(alpha=0.3)
    return figure
