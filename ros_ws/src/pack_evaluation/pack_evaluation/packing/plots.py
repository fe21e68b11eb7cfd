"""Plots of a run: what was seen, distance, force, iteration times, displacement, error of the estimate."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from pack_core.packing.free_space import footprint
from pack_core.rotations import Array
from pack_evaluation.figures import INK, RED, write_figures
from pack_evaluation.packing.criteria import Criteria
from pack_evaluation.packing.run import Run, SeenScene
from pack_evaluation.packing.video import OTHER_COLOUR, STAGE_COLOURS, STAGE_TITLES
from pack_evaluation.track import Track

SIZE = (9.0, 3.1)
"""Width and height of a figure [inch]."""

Draw = Callable[[Axes, Run], None]


def write_plots(run: Run, folder: Path) -> list[Path]:
    """Write every plot as PNG into `folder`, in the order a report shows them."""
    figures = {name: plot_of(run, draw) for name, draw in PLOTS.items()}
    if run.seen is not None:
        figures = {"seen": draw_seen(run, run.seen), **figures}
    return write_figures(figures, folder)


def draw_seen(run: Run, seen: SeenScene) -> Figure:
    """What was seen before the goal, as lines, over what was there: outlines from above."""
    figure = Figure(figsize=(0.6 * SIZE[0], 0.5 * SIZE[0]), layout="constrained")
    axes, container = figure.add_subplot(), run.scene.container
    moment = np.array([run.start])
    for item in run.scene.objects:
        outline = footprint(item, run.truth[item.name].at(moment).pose(0))
        axes.fill(*_cm(outline), color=item.colour, alpha=0.45, lw=0)
    for name, X_WO in seen.poses.items():
        axes.plot(*_cm(footprint(seen.scene.model_of(name), X_WO)), color=INK, lw=1.4)
    axes.plot(*_cm(shapely.box(*container.lower, *container.upper)), color=INK, lw=2.5, alpha=0.4)
    found = f"{len(seen.objects)} of {len(run.scene.objects)} objects found, {len(seen.poses)} seen"
    axes.set(title=f"Before the goal: {found}", xlabel="x [cm]", ylabel="y [cm]", aspect="equal")
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def _cm(outline: shapely.Polygon) -> tuple[Array, Array]:
    """Corners of an outline `(n,)` along x and y [cm], the first one again at the end."""
    x, y = 100.0 * shapely.get_coordinates(outline.exterior).T
    return x, y


def draw_distance(axes: Axes, run: Run) -> None:
    """True distance of the held object from its packing pose."""
    axes.set(title="Distance to the packing pose", ylabel="distance [cm]")
    if not run.iterations.times.size:
        return
    held = run.truth[run.held].between(run.iterations.times[0], run.end)
    rows = np.searchsorted(run.iterations.times, held.times, side="right") - 1
    distance = 100.0 * held.distance_to(run.iterations.p_WT[rows])
    axes.plot(held.times - run.start, distance, color=INK, lw=1.6)
    axes.axhline(100.0 * Criteria().distance, color=RED, lw=1.0, ls="--", label="placed")
    again = run.iterations.elapsed[1:][np.diff(run.iterations.placements) > 0]
    if again.size:
        axes.vlines(again, 0.0, distance.max(), color="#8e44ad", lw=1.0, ls=":", label="new placement")
    axes.set_ylim(bottom=0.0)


def draw_force(axes: Axes, run: Run) -> None:
    """Load on the cup less the held object's weight."""
    axes.set(title="Force at the tool", ylabel="force [N]")
    axes.plot(run.force_times - run.start, run.force, color=INK, lw=1.0)
    axes.set_ylim(bottom=0.0)


def draw_iterations(axes: Axes, run: Run) -> None:
    """Wall clock time of the controller's iterations."""
    axes.set(title="MPC iteration time", ylabel="wall clock [ms]")
    iterations = run.iterations
    if not iterations.ms.size:
        return
    colours = [STAGE_COLOURS.get(stage, OTHER_COLOUR) for stage in iterations.stages]
    axes.scatter(iterations.elapsed, iterations.ms, s=12, c=colours)
    median = float(np.median(iterations.ms))
    axes.axhline(median, color=INK, lw=1.0, ls="--", label=f"median {median:.0f} ms")
    axes.set_ylim(bottom=0.0)


def draw_displacement(axes: Axes, run: Run) -> None:
    """How far every object in the container has been moved."""
    axes.set(title="Displacement of the objects in the container", ylabel="displacement [cm]")
    for name, track in _tracks(run, run.truth):
        axes.plot(
            track.times - run.start, 100.0 * track.displacement(), lw=1.6,
            color=run.scene.model_of(name).colour, label=name.replace("_", " "),
        )  # fmt: skip
    axes.set_ylim(bottom=0.0)


def draw_estimate(axes: Axes, run: Run) -> None:
    """Error of the estimated positions; dots where the pose was predicted instead of seen."""
    axes.set(title="Error of the estimated positions (dots: predicted, not seen)", ylabel="error [mm]")
    for name, track in _tracks(run, run.estimate):
        error = 1e3 * track.distance_to(run.truth[name].at(track.times).p)
        colour, hidden = run.scene.model_of(name).colour, track.is_predicted
        axes.plot(track.times - run.start, error, lw=1.2, color=colour, label=name.replace("_", " "))
        axes.plot(track.times[hidden] - run.start, error[hidden], ".", ms=4, color=colour)
    axes.set_ylim(bottom=0.0)


PLOTS: dict[str, Draw] = {
    "distance": draw_distance,
    "force": draw_force,
    "iterations": draw_iterations,
    "displacement": draw_displacement,
    "estimate": draw_estimate,
}


def _tracks(run: Run, tracks: dict[str, Track]) -> Iterator[tuple[str, Track]]:
    return ((name, tracks[name].between(run.start, run.end)) for name in run.scene.names if name in tracks)


def plot_of(run: Run, draw: Draw) -> Figure:
    """A plot over the time of the goal, with the stages behind it."""
    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.add_subplot()
    draw(axes, run)
    names = _shade_stages(axes, run)
    axes.set(xlabel="time since the goal [s]", xlim=(0.0, run.end - run.start))
    axes.grid(alpha=0.25)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    _drop_names_without_room(figure, names)
    return figure


def _shade_stages(axes: Axes, run: Run) -> list[tuple[Text, float, float]]:
    """Colour the background by stage; returns every stage's name, and from when to when [s] it lasts."""
    stages, elapsed = run.iterations.stages, run.iterations.elapsed
    changes = [i for i in range(len(stages)) if i == 0 or stages[i] != stages[i - 1]]
    duration = run.end - run.start
    names = []
    bounds = [*(float(elapsed[i]) for i in changes), duration]
    for i, (start, end) in zip(changes, pairwise(bounds), strict=True):
        colour = STAGE_COLOURS.get(stages[i], OTHER_COLOUR)
        axes.axvspan(start, end, color=colour, alpha=0.10, lw=0)
        name = axes.text(
            0.5 * (start + end), 0.97, STAGE_TITLES.get(stages[i], stages[i]), color=colour, fontsize=8,
            transform=axes.get_xaxis_transform(), ha="center", va="top", fontweight="bold",
        )  # fmt: skip
        names.append((name, start, end))
    return names


def _drop_names_without_room(figure: Figure, names: list[tuple[Text, float, float]]) -> None:
    """Remove names that are wider than their stage, which others would hide or the edge would cut."""
    figure.draw_without_rendering()  # only now the layout has given the axes their width
    for name, start, end in names:
        axes = name.axes
        assert axes is not None
        left, right = axes.transData.transform([(start, 0.0), (end, 0.0)])[:, 0]
        if name.get_window_extent().width > right - left:
            name.remove()
