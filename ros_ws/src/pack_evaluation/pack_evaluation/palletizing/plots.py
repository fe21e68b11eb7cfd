"""Plots of a run: the tool's profiles, its tracking error, the ways of the boxes, the grips."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from pack_core.motion.moves import SLOW_SPEED
from pack_core.rotations import Array, Pose
from pack_evaluation.figures import BLUE, GREEN, GREY, INK, RED, write_figures
from pack_evaluation.palletizing.measures import tracking_errors
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.palletizing.state_times import slow_states, state_times, tool_speeds

SIZE = (9.0, 4.2)
"""Width and height of a figure [inch]."""
AXES = (RED, GREEN, BLUE)
"""Colours of x, y and z."""
SLOW_COLOUR, SHADE = "#e0a31e", 0.18
"""Colour of slow phases and states, and its opacity where it lies behind lines."""
PALLET_COLOUR = "#c8b48f"
MOST_NAMES = 25
"""Boxes that the legend of their ways names."""
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
    axes = figure.add_subplot()
    axes.set(ylabel="[m]", xlabel="time [s]")
    axes.set_title("Tool position", loc="left")
    p_wanted, _ = _commanded(run)
    _draw_channels(axes, run, dict(zip("xyz", AXES, strict=True)), run.tool.p, p_wanted)


def draw_orientation(figure: Figure, run: PalletRun) -> None:
    """Commanded and measured orientation as quaternions; slow phases are shaded."""
    axes = figure.add_subplot()
    axes.set(xlabel="time [s]", ylim=(-1.1, 1.1))
    axes.set_title("Tool orientation, quaternion", loc="left")
    q, (_, q_wanted) = continuous(run.tool.q), _commanded(run)
    colours = dict(zip("wxyz", ("#7a4bb0", *AXES), strict=True))
    _draw_channels(axes, run, colours, q, q_wanted * _signs(q_wanted, q)[:, None])


def _draw_channels(
    axes: Axes, run: PalletRun, colours: dict[str, str], measured: Array, commanded: Array
) -> None:
    """One colour a channel, measured solid and commanded dashed; slow phases shaded, boxes numbered."""
    times = run.tool.times[::STRIDE]
    handles: list[Artist] = []
    for i, (name, colour) in enumerate(colours.items()):
        handles += axes.plot(times, measured[::STRIDE, i], color=colour, lw=1.3, label=name)
        axes.plot(times, commanded[::STRIDE, i], color=colour, lw=0.9, ls="--", alpha=0.7)
    _shade(axes, run)
    _number_boxes(axes, run)
    axes.margins(x=0.0)
    axes.grid(axis="y", color=GREY, alpha=0.25, lw=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    handles += [Line2D([], [], color=INK, lw=1.3, label="measured"),
                Line2D([], [], color=INK, lw=0.9, ls="--", label="commanded"),
                Patch(color=SLOW_COLOUR, alpha=SHADE, lw=0.0, label="slow")]  # fmt: skip
    axes.legend(
        handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(handles), frameon=False,
        handlelength=1.8, columnspacing=1.1, fontsize=9,
    )  # fmt: skip


def _number_boxes(axes: Axes, run: PalletRun) -> None:
    """A thin line where work on each box begins, with its number in the sequence of placing."""
    numbers = {box.name: number for number, box in enumerate(run.boxes, start=1)}
    begins: dict[str, float] = {}
    for visit in run.visits:
        if visit.box in numbers:
            begins.setdefault(visit.box, visit.time)
    for name, time in begins.items():
        axes.vlines(time, 0.0, 1.0, color=GREY, lw=0.6, ls=":", zorder=0,
                    transform=axes.get_xaxis_transform())  # fmt: skip
        axes.text(time, 0.995, f" {numbers[name]}", color=GREY, fontsize=7, va="top",
                  transform=axes.get_xaxis_transform(), clip_on=True)  # fmt: skip


def _signs(q: Array, near: Array) -> Array:
    """Signs `(n,)` by which unit quaternions `(n, 4)` are those nearest to others.

    While one stays the same its sign does, too: that which suits the last of the others.
    """
    is_last = np.append(np.any(q[1:] != q[:-1], axis=1), True)
    last = np.flatnonzero(is_last)
    signs = np.where(np.sum(q[last] * near[last], axis=1) < 0.0, -1.0, 1.0)
    return np.asarray(np.repeat(signs, np.diff(last, prepend=-1)))


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
    """The way of every box from its spawn (ring) to the pallet (dot), as in Fig. 9.4."""
    axes = figure.add_subplot(projection="3d")
    _draw_places(axes, run)
    colours = colormaps["turbo"](np.linspace(0.05, 0.95, max(len(run.boxes), 1)))
    for box, colour in zip(run.boxes, colours, strict=True):
        if (track := run.tracks.get(box.name)) is not None:
            axes.plot(*track.p[::STRIDE].T, color=colour, lw=1.4, label=box.name)
            axes.scatter(*track.p[[0, -1]].T, s=22, edgecolor=[colour] * 2, facecolor=["white", colour])
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", zlim=(0.0, axes.get_zlim()[1]))
    axes.view_init(elev=26, azim=-50)
    axes.locator_params(nbins=5)
    axes.tick_params(labelsize=7)
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    axes.set_box_aspect(np.ptp(limits, axis=1), zoom=1.25)  # a metre is as long along every axis
    if 0 < len(run.boxes) <= MOST_NAMES:
        axes.legend(
            fontsize=7, loc="upper left", bbox_to_anchor=(-0.42, 0.95), frameon=False, title="box",
            title_fontsize=8, alignment="left",
        )  # fmt: skip


def _draw_places(axes: Axes3D, run: PalletRun) -> None:
    """Tops of the two tables and of the pallet, where they truly are."""
    cell = run.stands.cell
    pallet = cell.pallet
    middle = np.array([*(np.array(pallet.corner) + 0.5 * np.array(pallet.size)), pallet.deck_height])
    for place, X_WM, colour in (
        (cell.picking_table, Pose(cell.picking_table.middle), GREY),
        (cell.reorientation_table, Pose(cell.reorientation_table.middle), GREY),
        (pallet, Pose(middle), PALLET_COLOUR),
    ):
        corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [*place.size, 0.0] * 0.5
        top = place.displaced(X_WM).apply(corners)
        axes.add_collection3d(
            Poly3DCollection([top], facecolor=colour, edgecolor=INK, alpha=0.3, lw=0.6), autolim=True
        )


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
    colours = [SLOW_COLOUR if label in slow else AXES[2] for label in states]
    upper.bar(range(len(states)), [item.total_s / placed for item in states.values()], color=colours)
    upper.set(ylabel="time a box [s]", title="States: time, and highest speed of the tool (slow ones orange)")
    lower.bar(range(len(states)), [item.peak_mps for item in states.values()], color=colours)
    lower.axhline(SLOW_SPEED, color=AXES[0], lw=0.9, ls="--")
    lower.set(ylabel="[m/s]")
    lower.set_xticks(range(len(states)), list(states), rotation=60, ha="right", fontsize=7)


def draw_visitors(figure: Figure, run: PalletRun) -> None:
    """Distance of visitors from the arm and what it carries, its margin, and the speed of the tool."""
    upper, lower = figure.subplots(2, 1, sharex=True)
    for name, track in run.visitors.items():
        upper.plot(track.times, track.distance, lw=1.0, label=name)
    if run.separation is not None:
        kept = np.where(run.separation.is_under_way, run.separation.margin, np.nan)
        upper.plot(run.separation.times, kept, color=INK, lw=0.8, label="margin, under way")
    upper.axhline(0.1, color=AXES[0], lw=0.9, ls="--")
    upper.set(ylabel="distance [m]", ylim=(0.0, 3.0), title="Distance of visitors, and speed of the tool")
    if run.visitors:
        upper.legend(loc="upper right", ncols=4, fontsize=7)
    lower.plot(run.tool.times[::STRIDE], tool_speeds(run)[::STRIDE], color=INK, lw=0.8)
    lower.set(ylabel="tool [m/s]", xlabel="time [s]")


def _shade(axes: Axes, run: PalletRun) -> None:
    for start, end in run.slow:
        axes.axvspan(start, end, color=SLOW_COLOUR, alpha=SHADE, lw=0.0, zorder=0)


PLOTS: dict[str, Draw] = {
    "position": draw_position,
    "orientation": draw_orientation,
    "tracking": draw_tracking,
    "states": draw_states,
    "ways": draw_ways,
    "placement": draw_errors,
}
