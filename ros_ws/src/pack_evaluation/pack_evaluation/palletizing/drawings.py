"""Drawings of orders and of layouts: which box stands where, layer by layer."""

from __future__ import annotations

import textwrap
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

CARD, EDGE, WRONG = "#d9b38c", "#5c4326", "#c0392b"
BELOW, TARGET, CORRIDOR = "#eeeeee", "#e08a3c", "#4c9f70"
SIDES = (("from above", 0, 1), ("from the front", 0, 2), ("from the side", 1, 2))
"""Title of each plane view, and the axes of P that it shows."""
MOST_REASONS = 25
"""That are written out below a drawing; how many more there are is said."""
WIDTH = 130
"""Characters in a line of the reasons."""


def draw_order(order: Order, reasons: Sequence[str]) -> Figure:
    """The stack in space and from three sides, and every reason against it below.

    Args:
        order: the order as written.
        reasons: what is wrong with it; boxes that a reason names as `box 'id'` are red.
    """
    wrong = {item.id for item in order.boxes if any(f"box '{item.id}'" in reason for reason in reasons)}
    lines = [line for reason in reasons[:MOST_REASONS] for line in textwrap.wrap(reason, WIDTH)]
    if len(reasons) > MOST_REASONS:
        lines.append(f"and {len(reasons) - MOST_REASONS} more")
    below = 0.3 + 0.19 * max(len(lines), 1)
    figure = Figure(figsize=(13.0, 6.4 + below))
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        2, 3, top=0.90, bottom=(below + 0.5) / (6.4 + below), left=0.05, right=0.98, wspace=0.25, hspace=0.35,
        width_ratios=(1.6, 1.0, 1.0),
    )  # fmt: skip
    _draw_space(figure, grid[:, 0], order, wrong)
    for (title, i, j), place in zip(SIDES, (grid[0, 1:], grid[1, 1], grid[1, 2]), strict=True):
        _draw_side(figure.add_subplot(place), order, wrong, (i, j), title)
    verdict = "can be built" if not reasons else f"cannot be built, for {len(reasons)} reasons"
    figure.suptitle(
        f"{order.order_id}: {len(order.boxes)} boxes, {verdict}", color=WRONG if reasons else EDGE
    )
    figure.text(
        0.03, 0.15 / (6.4 + below), "\n".join(lines) or "No reason against it.", fontsize=8.5, va="bottom"
    )
    return figure


def _draw_space(figure: Figure, place: object, order: Order, wrong: set[str]) -> None:
    axes = figure.add_subplot(place, projection="3d")
    # Computed, it would sort whole bars by their middles, and that of the wide deck is far off.
    axes.computed_zorder = False
    axes.view_init(elev=24, azim=-55)
    pallet = order.pallet
    axes.bar3d(0, 0, -pallet.deck_height, pallet.length, pallet.width, pallet.deck_height,
               color="#c8b48f", edgecolor="#8a7a58", linewidth=0.4, alpha=0.6)  # fmt: skip
    for rank, item in enumerate(from_back_to_front(order.placed), start=2):  # the deck's is 1
        colour = WRONG if item.id in wrong else CARD
        bar = axes.bar3d(*item.lower, *item.size, color=colour, edgecolor=EDGE, linewidth=0.5, alpha=0.85)
        bar.set_zorder(rank)
    highest = max([0.3, *(float(item.upper[2]) for item in order.placed)])
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.set_box_aspect((pallet.length, pallet.width, highest + pallet.deck_height))


def from_back_to_front(boxes: Sequence[PlacedBox]) -> list[PlacedBox]:
    """The boxes in a sequence in which none hides one after it, seen from above, from +x and -y.

    A box may hide another only if it does not end where the other begins on the side away from the eye. Boxes
    that stand apart are always told apart so along one of the axes.
    """
    left, drawn = list(boxes), list[PlacedBox]()
    while left:
        free = (box for box in left if not any(_is_behind(other, box) for other in left if other is not box))
        following = next(free, left[0])
        left.remove(following)
        drawn.append(following)
    return drawn


def _is_behind(box: PlacedBox, other: PlacedBox) -> bool:
    """Whether `box` must be drawn before `other`: it lies below, farther in y, or nearer to x = 0."""
    x, y, z = (box.upper[0] <= other.lower[0], box.lower[1] >= other.upper[1], box.upper[2] <= other.lower[2])
    before = box.lower[0] >= other.upper[0], box.upper[1] <= other.lower[1], box.lower[2] >= other.upper[2]
    return bool(any((x, y, z)) and not any(before))


def _draw_side(axes: Axes, order: Order, wrong: set[str], plane: tuple[int, int], title: str) -> None:
    i, j = plane
    # What is nearer to the eye is drawn later: seen from above the higher, else the one with the smaller
    # coordinate along the axis of view.
    k = 3 - i - j
    away = 1.0 if k == 2 else -1.0
    boxes = sorted(order.placed, key=lambda box: away * float(box.upper[k]))
    for rank, item in enumerate(boxes, start=2):
        _draw_outline(axes, item, plane, rank, is_wrong=item.id in wrong)
    _draw_deck(axes, order.pallet, plane)
    axes.set_title(title, fontsize=9)
    axes.set_xlabel(f"{'xyz'[i]} [m]", fontsize=8)
    axes.set_ylabel(f"{'xyz'[j]} [m]", fontsize=8)
    axes.tick_params(labelsize=7)
    axes.autoscale_view()
    axes.set_aspect("equal")


def _draw_outline(axes: Axes, item: PlacedBox, plane: tuple[int, int], rank: int, *, is_wrong: bool) -> None:
    (x, y), (width, height) = item.lower[list(plane)].tolist(), item.size[list(plane)].tolist()
    colour = WRONG if is_wrong else CARD
    axes.add_patch(
        Rectangle((x, y), width, height, facecolor=colour, edgecolor=EDGE, linewidth=0.8, zorder=rank)
    )
    # With the rank of its box, so that a box in front of it covers it.
    axes.text(
        x + 0.5 * width, y + 0.5 * height, item.id, ha="center", va="center", fontsize=5.5, clip_on=True,
        zorder=rank,
    )  # fmt: skip


def _draw_deck(axes: Axes, pallet: OrderPallet, plane: tuple[int, int]) -> None:
    edges = (pallet.length, pallet.width, pallet.deck_height)
    lower = (0.0, -pallet.deck_height if plane[1] == 2 else 0.0)
    width, height = edges[plane[0]], edges[plane[1]]
    axes.add_patch(Rectangle(lower, width, height, fill=False, edgecolor="#888888", linestyle="--"))


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
