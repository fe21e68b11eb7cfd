"""Pictures of a layout: every layer from above, before and after, and how each box comes to its place."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon, Rectangle

from pack_core.palletizing.orders.layout_plan import LayoutPlan, PlannedBox, layers_of
from pack_core.palletizing.orders.order import Order, OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox

CARD, EDGE, BELOW, TARGET, CORRIDOR = "#d9b38c", "#5c4326", "#eeeeee", "#e08a3c", "#4c9f70"


def write_pictures(order: Order, plan: LayoutPlan, folder: Path) -> list[Path]:
    """Write the pictures of an order's layout as PNG files and return where they are."""
    folder.mkdir(parents=True, exist_ok=True)
    layout = folder / f"{order.order_id}_layout.png"
    draw_layers(order, plan).savefig(layout, dpi=110)
    paths = [layout]
    for k, item in enumerate(plan.boxes, start=1):
        path = folder / f"{order.order_id}_insertion_{k:02d}.png"
        draw_insertion(item, [earlier.placed for earlier in plan.boxes[: k - 1]], order.pallet).savefig(
            path, dpi=90
        )
        paths.append(path)
    return paths


def draw_layers(order: Order, plan: LayoutPlan) -> Figure:
    """A row for each layer: as ordered, and with gaps; boxes are numbered in the sequence of placing."""
    numbers = {item.placed.id: k for k, item in enumerate(plan.boxes, start=1)}
    before, after = order.placed, tuple(item.placed for item in plan.boxes)
    layers = layers_of(before)
    figure = Figure(figsize=(11, 0.5 + 3.6 * len(layers)), layout="constrained")
    FigureCanvasAgg(figure)
    for row, layer in enumerate(layers):
        names = {item.id for item in layer}
        for column, boxes in enumerate((before, after)):
            axes = figure.add_subplot(len(layers), 2, 2 * row + column + 1)
            _draw_pallet(axes, order.pallet)
            for item in boxes:
                if item.id in names:
                    _draw_box(axes, item, CARD, f"{numbers[item.id]}")
            what = "as ordered" if column == 0 else f"gaps of {plan.gap * 1e3:g} mm"
            axes.set_title(f"{what}, base at {layer[0].lower[2]:.3f} m", fontsize=9)
    return figure


def draw_insertion(item: PlannedBox, placed: Sequence[PlacedBox], pallet: OrderPallet) -> Figure:
    """One box's way in: its place, the corridor, and the boxes beside it."""
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    _draw_pallet(axes, pallet)
    for other in sorted(placed, key=lambda box: float(box.upper[2])):
        is_beside = other.is_beside(item.placed)
        _draw_box(axes, other, CARD if is_beside else BELOW, f"{other.upper[2]:.2f}")
    _draw_corridor(axes, item)
    _draw_box(axes, item.placed, TARGET, item.placed.id)
    insertion = item.insertion
    length = f", corridor {insertion.corridor:.2f} m" if insertion.corridor else ""
    axes.set_title(f"'{item.placed.id}' comes from: {insertion.direction}{length}", fontsize=9)
    return figure


def _draw_pallet(axes: Axes, pallet: OrderPallet) -> None:
    axes.add_patch(
        Rectangle((0, 0), pallet.length, pallet.width, fill=False, edgecolor="#888888", linestyle="--")
    )
    axes.set(xlim=(-0.15, pallet.length + 0.15), ylim=(-0.15, pallet.width + 0.15), aspect="equal")
    axes.set_xlabel("x [m]", fontsize=8)
    axes.set_ylabel("y [m]", fontsize=8)
    axes.tick_params(labelsize=7)


def _draw_box(axes: Axes, item: PlacedBox, colour: str, label: str) -> None:
    x, y, _ = item.lower
    axes.add_patch(
        Rectangle((x, y), item.size[0], item.size[1], facecolor=colour, edgecolor=EDGE, linewidth=0.8)
    )
    x_middle, y_middle, _ = item.centre
    axes.text(x_middle, y_middle, label, ha="center", va="center", fontsize=7)


def _draw_corridor(axes: Axes, item: PlannedBox) -> None:
    """Draw the area that the box sweeps on its way in, and an arrow from the start to its place."""
    insertion, centre = item.insertion, item.placed.centre
    if not insertion.corridor:
        axes.plot(*centre[:2], "o", color=CORRIDOR, markersize=14, zorder=5)
        return
    start = insertion.start(centre)
    half = 0.5 * item.placed.size[:2]
    corners = np.array([[sx, sy] for sx in (-1, 1) for sy in (-1, 1)]) * half
    across = np.array([-insertion.outward[1], insertion.outward[0]])
    reach = corners @ across
    low, high = corners[np.argmin(reach)], corners[np.argmax(reach)]
    outline = [centre[:2] + low, start[:2] + low, start[:2] + high, centre[:2] + high]
    axes.add_patch(Polygon(outline, facecolor=CORRIDOR, alpha=0.25, zorder=4))
    axes.add_patch(
        FancyArrowPatch(
            tuple(start[:2]), tuple(centre[:2]), arrowstyle="-|>", mutation_scale=16, color=CORRIDOR, zorder=5
        )
    )
