"""Packs boxes onto a pallet one by one, each where it fits best among those that stand already.

A box is let down from above at candidate positions: the corners that boxes, which stand already, leave (the
extreme points of Crainic, Perboli, Tadei, "Extreme point-based heuristics for three-dimensional bin
packing", 2008, seen from above, from both sides). Of the positions at which it is stable, it takes the one
that lets the box around the whole stack grow least: the least-surface-area heuristic of Hu et al., "Solving
a new 3D bin packing problem with deep reinforcement learning method", 2017.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.palletizing.orders.handling import PRICE, Handling, TurnChoice
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.placed_box import TOUCH, PlacedBox
from pack_core.palletizing.orders.support import SupportConfig, support_of
from pack_core.rotations import Array

Turns = Mapping[str, Sequence[TurnChoice]]


class PackerConfig(Config):
    """Parameters of the packer."""

    gap: NonNegativeFloat = Field(0.002, le=0.05, description="free distance between neighbours [m]")
    highest: PositiveFloat = Field(1.0, description="stack over the deck, at most [m]")
    handling_price: NonNegativeFloat = Field(
        0.01, description="growth of the stack's surface that a costlier turn is worth [m^2]"
    )
    support: SupportConfig = SupportConfig()


@dataclass(frozen=True)
class PackedItem:
    """An item at its place, and the turn that brings it there."""

    item: Item
    turn: TurnChoice
    placed: PlacedBox


@dataclass(frozen=True)
class Packing:
    """The outcome of packing a list of items.

    Attributes:
        packed: the items that found a place, in the sequence in which they were placed.
        left: those that did not.
    """

    packed: tuple[PackedItem, ...]
    left: tuple[Item, ...]

    @property
    def fill(self) -> float:
        """Share of the box around the stack, all its layers, that the boxes take up; 0 without boxes."""
        if not self.packed:
            return 0.0
        volume = sum(float(np.prod(entry.placed.size)) for entry in self.packed)
        return volume / float(np.prod(self.extents))

    @property
    def stood_up(self) -> int:
        """Number of boxes that are stood up on the table on their way."""
        return sum(entry.turn.handling is Handling.TABLE for entry in self.packed)

    @property
    def extents(self) -> Array:
        """Edges of the box around the stack `(3,)` [m], from the deck upwards."""
        upper = np.max([entry.placed.upper for entry in self.packed], axis=0)
        lower = np.min([entry.placed.lower for entry in self.packed], axis=0)
        return np.array([*(upper - lower)[:2], upper[2]])


def pack_in_sequence(
    items: Sequence[Item], turns: Turns, area: tuple[float, float], config: PackerConfig, *,
    by_height: bool = False,
) -> Packing:  # fmt: skip
    """Pack items in the given sequence; where one stands does not depend on those after it.

    Args:
        items: the items in the sequence of their arrival.
        turns: the turns that each item may be given, by its id.
        area: length and width of the area that may be covered [m].
        config: parameters.
        by_height: take the lowest place rather than the one with the least surface.
    """
    packed: list[PackedItem] = []
    left: list[Item] = []
    for item in items:
        stack = [entry.placed for entry in packed]
        best = _best(item, turns[item.id], stack, area, config, by_height=by_height)
        left.append(item) if best is None else packed.append(best)
    return Packing(tuple(packed), tuple(left))


def _best(
    item: Item, turns: Sequence[TurnChoice], stack: Sequence[PlacedBox], area: tuple[float, float],
    config: PackerConfig, *, by_height: bool,
) -> PackedItem | None:  # fmt: skip
    """The best stable place of an item; None where there is none."""
    ranked: list[tuple[tuple[float, ...], TurnChoice, Array]] = []
    for turn in turns:
        size = np.array(turn.extents)
        for p in _places(size, stack, area, config):
            ranked.append((_cost(p, size, turn, stack, config, by_height=by_height), turn, p))
    for _, turn, p in sorted(ranked, key=lambda entry: entry[0]):
        placed = PlacedBox(item.id, p, np.array(turn.extents), item.weight)
        # The costly question is asked last, and of the cheapest places first.
        if support_of(placed, stack).problem(config.support) is None:
            return PackedItem(item, turn, placed)
    return None


def _places(
    size: Array, stack: Sequence[PlacedBox], area: tuple[float, float], config: PackerConfig
) -> list[Array]:
    """Lower corners `(3,)` at which a box of `size` `(3,)` comes to rest when it is let down from above."""
    if not stack:
        return [np.zeros(3)] if np.all(size[:2] <= np.array(area) + TOUCH) else []
    lower, upper = (np.array([getattr(box, end) for box in stack]) for end in ("lower", "upper"))
    xs, ys = (_coordinates(lower[:, k], upper[:, k], float(size[k]), area[k], config.gap) for k in (0, 1))
    corners = np.array([[x, y] for x in xs for y in ys]).reshape(-1, 2)
    # A box is in the way if, seen from above, it is nearer than the gap.
    grown = config.gap - TOUCH
    is_over = np.all(
        (corners[:, None] < upper[None, :, :2] + grown)
        & (corners[:, None] + size[:2] > lower[None, :, :2] - grown),
        axis=2,
    )
    heights = np.where(is_over, upper[:, 2], 0.0).max(axis=1)
    fits = heights + size[2] <= config.highest + TOUCH
    return [np.array([*corner, z]) for corner, z in zip(corners[fits], heights[fits], strict=True)]


def _coordinates(lower: Array, upper: Array, edge: float, length: float, gap: float) -> list[float]:
    """Where a box may begin along one axis: at the border, flush with a box, or a gap beside one."""
    wished = [0.0, *lower, *(upper - edge), *(upper + gap), *(lower - gap - edge)]
    return sorted({round(float(x), 4) for x in wished if x >= -TOUCH and x + edge <= length + TOUCH})


def _cost(
    p: Array, size: Array, turn: TurnChoice, stack: Sequence[PlacedBox], config: PackerConfig, *,
    by_height: bool,
) -> tuple[float, ...]:  # fmt: skip
    """What a place costs; the smallest is taken."""
    upper = np.max([p + size, *(box.upper for box in stack)], axis=0)
    lower = np.min([p, *(box.lower for box in stack)], axis=0)
    length, width = (float(edge) for edge in (upper - lower)[:2])
    height = float(upper[2])
    surface = 2.0 * (length * width + (length + width) * height)
    price = config.handling_price * PRICE[turn.handling]
    near = float(p[0] + p[1])
    top = float(p[2] + size[2])
    return (top + price, surface, near) if by_height else (surface + price, top, near)
