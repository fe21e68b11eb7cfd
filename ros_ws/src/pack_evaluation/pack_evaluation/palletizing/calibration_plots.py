"""Plots of what a calibration leaves unexplained."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from pack_core.rotations import Array
from pack_evaluation.figures import GREY, INK, RED, write_figures

ENLARGED = 400.0
"""Residuals of corners are drawn so much larger than the picture."""


def write_calibration_plots(
    views: Sequence[tuple[Array, Array]], touches: Sequence[tuple[str, float, float]], folder: Path
) -> list[Path]:
    """Write the plots as PNG.

    Args:
        views: pixels of the corners of each view `(n, 2)`, and their residuals `(n, 2)` [pixel].
        touches: name, residual [m] and standard deviation [m] of each touch.
        folder: takes them.
    """
    plots = {"residuals_board": _board(views), "residuals_touches": _touches(touches)}
    return write_figures(plots, folder, dpi=110)


def _board(views: Sequence[tuple[Array, Array]]) -> Figure:
    figure = Figure(figsize=(11.0, 4.8), layout="constrained")
    where, spread = figure.subplots(1, 2)
    pixels, off = (np.concatenate([view[k] for view in views]) for k in (0, 1))
    where.quiver(*pixels.T, *(ENLARGED * off.T), angles="xy", scale_units="xy", scale=1.0, width=0.0015)
    where.set(title=f"Corners of the board, {ENLARGED:.0f} times", xlabel="u [pixel]", ylabel="v [pixel]")
    where.set_aspect("equal")
    where.invert_yaxis()
    spread.boxplot([np.linalg.norm(view[1], axis=1) for view in views], showfliers=False)
    spread.set(title="Each picture", xlabel="picture", ylabel="residual [pixel]")
    spread.tick_params(axis="x", labelsize=7)
    return figure


def _touches(touches: Sequence[tuple[str, float, float]]) -> Figure:
    figure = Figure(figsize=(8.0, 0.3 * len(touches) + 1.2), layout="constrained")
    axes = figure.add_subplot()
    names, off, sigma = zip(*touches, strict=True)
    rows = np.arange(len(names))
    axes.errorbar(1e3 * np.array(off), rows, xerr=1e3 * np.array(sigma), fmt="o", color=INK, ecolor=GREY)
    axes.axvline(0.0, color=RED, lw=0.8)
    axes.set_yticks(rows, names)
    axes.invert_yaxis()
    axes.set(title="Touches: distance from the fitted surface, and what is known of it", xlabel="[mm]")
    return figure
