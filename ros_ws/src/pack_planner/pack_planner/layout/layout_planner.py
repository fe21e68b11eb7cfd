"""Plans an order's layout: places with gaps, a sequence the arm can reach, and a side each box comes from."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.config import NEXT_REQUEST, Changeable, Config
from pack_core.errors import PackError
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus, PlannedBox, resequence
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.order import Order, OrderPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.support import SupportConfig, unstable_boxes
from pack_planner.layout.insertion_direction import INSERTION_RULES, InsertionConfig
from pack_planner.layout.pallet_separator import SEPARATORS, Separation, SeparatorConfig

MAX_GAP = 0.05
"""Largest gap that a request may ask for, the bound of the configured ones as well [m]."""


class LayoutConfig(Config):
    """Parameters of the layout service."""

    changeable: ClassVar[Changeable] = NEXT_REQUEST

    separator: SeparatorConfig = SeparatorConfig()
    insertion: InsertionConfig = InsertionConfig()
    support: SupportConfig = SupportConfig()
    rise: PositiveFloat = Field(
        0.12,
        description="boxes whose top is at most this far over the lowest free base keep their sequence [m]",
    )


class LayoutPlanner:
    """Plans the layouts of orders."""

    def __init__(self, config: LayoutConfig) -> None:
        self._config = config

    def plan(self, order: Order, gap: float | None = None) -> LayoutPlan:
        """Plan an order's layout with a gap [m]; None: with a gap that adapts to the layout (Eq. 6.7).

        Of the configured range, it is the widest gap that needs no virtual margin and leaves every box
        stable. Where there is none, the configured gap is tried with a virtual margin, and then smaller ones.

        Raises:
            PackError: the gap is not allowed, or boxes overlap as given.
        """
        if gap is not None:
            return self._with_gap(order, gap)
        config = self._config.separator
        for wider in _steps(config.widest_gap, config.gap, config.gap_step):
            plan = self._with_gap(order, wider)
            if plan.status is LayoutStatus.SUCCESS and plan.virtual_margin == 0.0:
                return plan
        plan = self._with_gap(order, config.gap)
        for smaller in _steps(config.gap, config.least_gap, config.gap_step)[1:]:
            if plan.status is LayoutStatus.SUCCESS:
                break
            tried = self._with_gap(order, smaller)
            plan = tried if tried.status is LayoutStatus.SUCCESS else plan
        return plan

    def _with_gap(self, order: Order, wanted: float) -> LayoutPlan:
        if not 0.0 <= wanted <= MAX_GAP:
            raise PackError(f"gap is {wanted} m; allowed: 0 to {MAX_GAP} m")
        config = self._config.separator
        separation = SEPARATORS[config.method](order.pallet, config).separate(order.placed, wanted)
        status, reason = self._judge(separation, wanted)
        boxes = self._planned(separation.boxes, order.pallet) if status is LayoutStatus.SUCCESS else ()
        return LayoutPlan(status, reason, boxes, wanted, separation.virtual_margin)

    def _judge(self, separation: Separation, gap: float) -> tuple[LayoutStatus, str]:
        if not separation.is_feasible:
            return LayoutStatus.INFEASIBLE, (
                f"no gap of {gap * 1e3:g} mm between all neighbours, even with boxes "
                f"{separation.virtual_margin * 1e3:g} mm over the pallet's edge and displaced by up to "
                f"{self._config.separator.max_shift:g} gaps; allowed: a smaller gap, or a looser layout"
            )
        if overlaps := overlapping(separation.boxes):
            pairs = "; ".join(f"'{one}' and '{other}'" for one, other in overlaps)
            return LayoutStatus.INFEASIBLE, f"with gaps of {gap * 1e3:g} mm boxes share space: {pairs}"
        unstable = {
            **overloaded_boxes(separation.boxes), **unstable_boxes(separation.boxes, self._config.support)
        }  # fmt: skip
        if unstable:
            reasons = "; ".join(f"box '{name}': {problem}" for name, problem in unstable.items())
            return LayoutStatus.UNSTABLE, f"with gaps of {gap * 1e3:g} mm: {reasons}"
        return LayoutStatus.SUCCESS, ""

    def _planned(self, boxes: Sequence[PlacedBox], pallet: OrderPallet) -> tuple[PlannedBox, ...]:
        sequence, config = resequence(boxes, self._config.rise), self._config.insertion
        choose = INSERTION_RULES[config.rule]
        return tuple(
            PlannedBox(item, choose(item, sequence[:k], config, pallet)) for k, item in enumerate(sequence)
        )


def overlapping(boxes: Sequence[PlacedBox]) -> list[tuple[str, str]]:
    """Names of the boxes that share space, in pairs: a separator may part some boxes and not others."""
    return [(one.id, other.id) for one, other in combinations(boxes, 2) if one.overlaps(other)]


def _steps(first: float, last: float, step: float) -> list[float]:
    """Gaps [m] from the first down to the last one, both included; none where the first is smaller."""
    if first < last:
        return []
    count = int(np.ceil((first - last) / step - 1e-9))
    return [max(round(first - k * step, 6), last) for k in range(count + 1)]
