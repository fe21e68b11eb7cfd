"""Plots of a run: the tool's profiles, its tracking error, the ways of the boxes, the grips."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pack_core.motion.moves import SLOW_SPEED
from pack_core.rotations import Array
from pack_evaluation.figures import BLUE, GREEN, GREY, INK, RED, write_figures
from pack_evaluation.palletizing.measures import tracking_errors
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.palletizing.state_times import slow_states, state_times, tool_speeds

SIZE = (9.0, 4.2)
"""Width and height of a figure [inch]."""
AXES = (RED, GREEN, BLUE)
"""Colours of x, y and z."""
STRIDE = 5
"""Only every fifth sample is drawn."""
DPI = 110
"""Of the plots' pixels, in an inch."""

Draw = Callable[[Figure, PalletRun], None]


def write_plots(run: PalletRun, folder: Path) -> list[Path]:
    """Write every plot as PNG into `folder`, in the order a report shows them."""
    plots = {**PLOTS, **({"visitors": draw_visitors} if run.visitors else {})}
    return write_figures({name: _plot_of(run, draw) for name, draw in plots.items()}, folder, DPI)


def visitors_picture(run: PalletRun) -> bytes | None:
    """The plot of visitors as PNG; None where nobody came."""
    if not run.visitors:
        return None
    picture = BytesIO()
    _plot_of(run, draw_visitors).savefig(picture, format="png", dpi=DPI)
    return picture.getvalue()


def _plot_of(run: PalletRun, draw: Draw) -> Figure:
    figure = Figure(figsize=SIZE, layout="constrained")
    draw(figure, run)
    return figure


def draw_position(figure: Figure, run: PalletRun) -> None:
    """Commanded and measured position; slow phases are shaded, as in Fig. 9.2.

    Commanded are the targets of the states, where they are known, else the setpoints.
    """
    axes, tool = figure.add_subplot(), run.tool
    axes.set(title="Tool position: measured (solid) and commanded (dashed)", ylabel="[m]", xlabel="time [s]")
    p_wanted, _ = _commanded(run)
    for i, (name, colour) in enumerate(zip("xyz", AXES, strict=True)):
        axes.plot(tool.times[::STRIDE], tool.p[::STRIDE, i], color=colour, lw=1.2, label=name)
        axes.plot(tool.times[::STRIDE], p_wanted[::STRIDE, i], color=INK, lw=0.8, ls="--")
    _shade(axes, run)
    axes.legend(loc="upper right", ncols=3)


def draw_orientation(figure: Figure, run: PalletRun) -> None:
    """Commanded and measured orientation as quaternions; slow phases are shaded."""
    axes, tool = figure.add_subplot(), run.tool
    axes.set(title="Tool orientation, quaternion: measured (solid) and commanded (dashed)", xlabel="time [s]")
    q, (_, q_wanted) = continuous(tool.q), _commanded(run)
    q_ref = q_wanted * np.where(np.sum(q_wanted * q, axis=1) < 0.0, -1.0, 1.0)[:, None]
    for i, (name, colour) in enumerate(zip("wxyz", ("#7a4bb0", *AXES), strict=True)):
        axes.plot(tool.times[::STRIDE], q[::STRIDE, i], color=colour, lw=1.2, label=name)
        axes.plot(tool.times[::STRIDE], q_ref[::STRIDE, i], color=INK, lw=0.8, ls="--")
    _shade(axes, run)
    axes.legend(loc="upper right", ncols=4)


def _commanded(run: PalletRun) -> tuple[Array, Array]:
    """Commanded positions `(n, 3)` and orientations `(n, 4)` at the times of the tool."""
    tool = run.tool
    if not run.targets:
        return tool.p_ref, tool.q_ref
    newest = np.searchsorted([target.time for target in run.targets], tool.times, side="right") - 1
    is_before = newest < 0
    p = np.array([target.X_WT.p for target in run.targets])[newest]
    q = np.array([target.X_WT.q for target in run.targets])[newest]
    return np.where(is_before[:, None], tool.p_ref, p), np.where(is_before[:, None], tool.q_ref, q)


def continuous(q: Array) -> Array:
    """The same rotations as unit quaternions `(n, 4)` whose signs make them continuous."""
    flips = np.where(np.sum(q[1:] * q[:-1], axis=1) < 0.0, -1.0, 1.0)
    return np.asarray(q * np.concatenate([[1.0], np.cumprod(flips)])[:, None])


def draw_tracking(figure: Figure, run: PalletRun) -> None:
    """Distance and angle between commanded and measured tool."""
    upper, lower = figure.subplots(2, 1, sharex=True)
    position_mm, angle_deg = tracking_errors(run.tool)
    for axes, values, unit in ((upper, position_mm, "mm"), (lower, angle_deg, "deg")):
        axes.plot(run.tool.times, values, color=INK, lw=0.7)
        axes.set(ylabel=f"[{unit}]", ylim=(0.0, None))
        _shade(axes, run)
    upper.set_title("Tracking error")
    lower.set_xlabel("time [s]")


def draw_ways(figure: Figure, run: PalletRun) -> None:
    """The way of every box from its spawn to the pallet, as in Fig. 9.4."""
    axes = figure.add_subplot(projection="3d")
    colours = colormaps["turbo"](np.linspace(0.05, 0.95, max(len(run.boxes), 1)))
    for box, colour in zip(run.boxes, colours, strict=True):
        if (track := run.tracks.get(box.name)) is not None:
            axes.plot(*track.p[::STRIDE].T, color=colour, lw=1.2, label=box.name)
    axes.set(title="Ways of the boxes", xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.view_init(elev=28, azim=-60)
    axes.set_box_aspect((3.2, 3.2, 1.6))
    if len(run.boxes) <= 8:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.05, 0.5))


def draw_errors(figure: Figure, run: PalletRun) -> None:
    """Errors of the placed boxes' final positions along x, y and z."""
    axes = figure.add_subplot()
    axes.set(title="Placement error at the end", ylabel="[mm]")
    placed = [box for box in run.boxes if box.outcome == "placed"]
    errors = [1e3 * (run.tracks[box.name].p[-1] - box.X_WB.p) for box in placed]
    for i, (name, colour) in enumerate(zip("xyz", AXES, strict=True)):
        places = np.arange(len(placed)) + 0.25 * (i - 1)
        axes.bar(places, [error[i] for error in errors], 0.22, color=colour, label=name)
    axes.set_xticks(range(len(placed)), [box.name for box in placed], rotation=60, ha="right", fontsize=7)
    axes.axhline(0.0, color=GREY, lw=0.8)
    axes.legend()


def draw_states(figure: Figure, run: PalletRun) -> None:
    """Time in each state for a box, and the highest speed of the tool in it; slow states are shaded."""
    upper, lower = figure.subplots(2, 1, sharex=True)
    states = {label: item for label, item in state_times(run).items() if item.total_s > 0.0}
    placed = max(sum(box.outcome == "placed" for box in run.boxes), 1)
    slow = slow_states(run)
    colours = ["#e0a31e" if label in slow else AXES[2] for label in states]
    upper.bar(range(len(states)), [item.total_s / placed for item in states.values()], color=colours)
    upper.set(ylabel="time a box [s]", title="States: time, and highest speed of the tool (slow ones orange)")
    lower.bar(range(len(states)), [item.peak_mps for item in states.values()], color=colours)
    lower.axhline(SLOW_SPEED, color=AXES[0], lw=0.9, ls="--")
    lower.set(ylabel="[m/s]")
    lower.set_xticks(range(len(states)), list(states), rotation=60, ha="right", fontsize=7)


def draw_visitors(figure: Figure, run: PalletRun) -> None:
    """True distance of visitors from the arm and what it carries, and the speed of the tool."""
    upper, lower = figure.subplots(2, 1, sharex=True)
    for name, track in run.visitors.items():
        upper.plot(track.times, track.distance, lw=1.0, label=name)
    upper.axhline(0.1, color=AXES[0], lw=0.9, ls="--")
    upper.set(ylabel="distance [m]", ylim=(0.0, 3.0), title="Distance of visitors, and speed of the tool")
    if run.visitors:
        upper.legend(loc="upper right", ncols=4, fontsize=7)
    lower.plot(run.tool.times[::STRIDE], tool_speeds(run)[::STRIDE], color=INK, lw=0.8)
    lower.set(ylabel="tool [m/s]", xlabel="time [s]")


def _shade(axes: Axes, run: PalletRun) -> None:
    for start, end in run.slow:
        axes.axvspan(start, end, color="#e0a31e", alpha=0.13, lw=0.0)


PLOTS: dict[str, Draw] = {
    "position": draw_position,
    "orientation": draw_orientation,
    "tracking": draw_tracking,
    "states": draw_states,
    "ways": draw_ways,
    "placement": draw_errors,
}
