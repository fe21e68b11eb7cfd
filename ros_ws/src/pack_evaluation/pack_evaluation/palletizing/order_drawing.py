"""A picture of an order as it was written, with whatever is wrong with it in red."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pack_core.palletizing.orders.order import Order, OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox

CARD, EDGE, WRONG = "#d9b38c", "#5c4326", "#c0392b"
SIDES = (("from above", 0, 1), ("from the front", 0, 2), ("from the side", 1, 2))
"""Title of each plane view, and the axes of P that it shows."""
MOST_REASONS = 25
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
    pallet = order.pallet
    axes.bar3d(0, 0, -pallet.deck_height, pallet.length, pallet.width, pallet.deck_height,
               color="#c8b48f", edgecolor="#8a7a58", linewidth=0.4, alpha=0.6)  # fmt: skip
    for item in sorted(order.placed, key=lambda box: (float(box.lower[2]), -float(box.lower[1]))):
        colour = WRONG if item.id in wrong else CARD
        axes.bar3d(*item.lower, *item.size, color=colour, edgecolor=EDGE, linewidth=0.5, alpha=0.85)
    highest = max([0.3, *(float(item.upper[2]) for item in order.placed)])
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.set_box_aspect((pallet.length, pallet.width, highest + pallet.deck_height))
    axes.view_init(elev=24, azim=-55)


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
