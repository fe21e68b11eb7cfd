"""Parts the boxes of an ideal layout until there is a gap between all neighbours (Sec. 6.2 of the thesis).

The thesis corrects conflicting pairs one after another, along the axis that needs less, by shares of the
free margin, and enlarges the pallet virtually where that fails. Here all pairs are corrected at once: a
search chooses for each pair the axis along which it is parted and which box comes first, and computes the
least displacement that fulfils all choices; others are tried as long as they could be cheaper. Pairs are all
boxes that overlap in height, not those of one layer alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated, Protocol

import numpy as np
from pydantic import AfterValidator, Field, NonNegativeFloat, PositiveFloat, PositiveInt

from pack_core.config import Config
from pack_core.palletizing.orders.order import OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.register import Register
from pack_core.rotations import Array
from pack_planner.layout.axis_program import AxisProgram, Relation
from pack_planner.layout.choices import Search


class Separator(Protocol):
    """Makes gaps in layouts for one kind of pallet."""

    def separate(self, boxes: Sequence[PlacedBox], gap: float | None = None) -> Separation:
        """Part the boxes by `gap` [m]; None: by the configured gap."""


MakeSeparator = Callable[[OrderPallet, "SeparatorConfig"], Separator]

SEPARATORS: Register[MakeSeparator] = Register(
    "separator",
    "pack_planner.separators",
    {"least_displacement": "pack_planner.layout.pallet_separator:PalletSeparator"},
)
"""The ways to part boxes by their names, the default first."""


class SeparatorConfig(Config):
    """Parameters of the separation."""

    method: Annotated[str, AfterValidator(SEPARATORS.known)] = Field(
        "least_displacement", description="how boxes are parted"
    )
    gap: NonNegativeFloat = Field(0.002, le=0.05, description="free distance between neighbours [m]")
    least_gap: NonNegativeFloat = Field(
        0.001, le=0.05, description="what the gap may shrink to where there is no room for it [m]"
    )
    widest_gap: NonNegativeFloat = Field(
        0.002, le=0.05, description="what the gap may grow to where there is room on the pallet [m]"
    )
    gap_step: PositiveFloat = Field(0.0005, description="by which it shrinks and grows [m]")
    max_shift: PositiveFloat = Field(5.0, description="no box is displaced further along an axis [gaps]")
    margin_step: PositiveFloat = Field(0.001, description="the virtual pallet margin grows by this [m]")
    max_margin: NonNegativeFloat = Field(0.02, description="largest virtual pallet margin [m]")
    max_choices: PositiveInt = Field(2000, description="choices of sides tried for one virtual margin")


@dataclass(frozen=True)
class Separation:
    """A layout with gaps.

    Attributes:
        boxes: the given boxes, displaced; as they were where the gap cannot be reached.
        displacements: along x and y `(n, 2)` [m].
        gap: smallest gap between any two neighbours [m]; infinite where there are no neighbours.
        virtual_margin: how far boxes may stand over the pallet's edge to reach the gap [m].
        is_feasible: whether the wanted gap was reached.
        is_minimal: whether it is proven that no other choice of sides costs less.
    """

    boxes: tuple[PlacedBox, ...]
    displacements: Array
    gap: float
    virtual_margin: float
    is_feasible: bool
    is_minimal: bool


class PalletSeparator:
    """Makes gaps in layouts for one kind of pallet."""

    def __init__(self, pallet: OrderPallet, config: SeparatorConfig) -> None:
        self._pallet, self._config = pallet, config

    def separate(self, boxes: Sequence[PlacedBox], gap: float | None = None) -> Separation:
        """Part the boxes by `gap` [m]; None: by the configured gap."""
        wanted = self._config.gap if gap is None else gap
        steps = round(self._config.max_margin / self._config.margin_step)
        # The smallest virtual margin that is feasible is taken: 0 first, then one step more each time.
        for margin in self._config.margin_step * np.arange(steps + 1):
            search = self._search(boxes, wanted, float(margin))
            if search.displacements is not None:
                moved = tuple(
                    item.moved([*shift, 0.0]) for item, shift in zip(boxes, search.displacements, strict=True)
                )
                return Separation(
                    moved, search.displacements, smallest_gap(moved), float(margin), True, search.is_complete
                )
        still = np.zeros((len(boxes), 2))
        return Separation(tuple(boxes), still, smallest_gap(boxes), self._config.max_margin, False, False)

    def _search(self, boxes: Sequence[PlacedBox], gap: float, margin: float) -> Search:
        follow = support_shares(boxes)
        lower, upper = (np.array([getattr(item, end) for item in boxes]) for end in ("lower", "upper"))
        programs = [
            AxisProgram(lower[:, k], upper[:, k], follow, length, gap, margin, self._config.max_shift * gap)
            for k, length in enumerate((self._pallet.length, self._pallet.width))
        ]
        search = Search(programs, neighbours(boxes), self._config.max_choices)
        search.run()
        return search


def neighbours(boxes: Sequence[PlacedBox]) -> list[Relation]:
    """Index pairs of boxes that overlap in height, so that there must be a gap between them."""
    pairs = combinations(range(len(boxes)), 2)
    return [(i, j) for i, j in pairs if boxes[i].is_beside(boxes[j])]


def smallest_gap(boxes: Sequence[PlacedBox]) -> float:
    """Smallest gap [m] between any two boxes that overlap in height; infinite where no two do."""
    gaps = [float(boxes[i].clearance(boxes[j])[:2].max()) for i, j in neighbours(boxes)]
    return min(gaps, default=float("inf"))


def support_shares(boxes: Sequence[PlacedBox]) -> Array:
    """Share of each box's carried base that lies on each other box `(n, n)`; rows of zeros on the deck."""
    areas = np.array([[_shared_area(upper, lower) for lower in boxes] for upper in boxes])
    totals = areas.sum(axis=1, keepdims=True)
    return np.asarray(areas / np.where(totals > 0.0, totals, 1.0))  # rows without support stay zero


def _shared_area(upper: PlacedBox, lower: PlacedBox) -> float:
    # Both clearances are negative overlaps here, so that their product is the shared area.
    return float(np.prod(upper.clearance(lower)[:2])) if upper.rests_on(lower) else 0.0
