"""The boxes of an order: the one in work, the next one, and the poses of those that have been put down."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PALLET, PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan
from pack_core.palletizing.orders.order import Order, OrderBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.rotations import Pose
from pallet_fsm.report import BoxOutcome, BoxReport
from pallet_fsm.tool_poses import placed_pose
from pallet_fsm.work_item import WorkItem

BESIDE = 0.02
"""Boxes nearer to a place than this may be touched when a box is put there [m]."""


class OrderBook:
    """Work items in the sequence of the plan.

    Args:
        order: what to build.
        plan: where every box goes.
        cell: the cell's physical facts.

    Attributes:
        current: the box in work.
    """

    def __init__(self, order: Order, plan: LayoutPlan, cell: PalletizingCell) -> None:
        self._cell = cell
        self.items = [WorkItem(order.box(planned.placed.id), planned) for planned in plan.boxes]
        self._furniture = cell.furniture
        self.current = self.items[0]

    @property
    def upcoming(self) -> WorkItem | None:
        """The next box, once the current one is finished; None where there is none."""
        return next((item for item in self.items if not item.is_finished and item is not self.current), None)

    @property
    def has_boxes(self) -> bool:
        """Whether any box is not finished yet."""
        return any(not item.is_finished for item in self.items)

    def advance(self) -> None:
        """Make the next box the current one if the current one is finished."""
        if self.current.is_finished and self.upcoming is not None:
            self.current = self.upcoming

    def skip(self, reason: str) -> None:
        """Leave out the current box, and all boxes that would rest on it."""
        self.current.finish(BoxOutcome.SKIPPED, reason)
        self.current.X_WB = None
        for item in self.items:
            missing = [other.name for other in self.items if other.outcome is BoxOutcome.SKIPPED
                       and item.plan.placed.rests_on(other.plan.placed)]  # fmt: skip
            if missing and not item.is_finished:
                item.finish(BoxOutcome.SKIPPED, f"it would rest on {', '.join(missing)}, which was skipped")

    def obstacles(self) -> tuple[Obstacle, ...]:
        """The furniture, and every box whose pose is known."""
        boxes = (standing_box(item.box, item.X_WB) for item in self.items if item.X_WB is not None)
        return (*self._furniture, *boxes)

    def on_pallet(self) -> tuple[Obstacle, ...]:
        """The boxes that were placed."""
        return tuple(
            standing_box(item.box, item.X_WB)
            for item in self.items
            if item.outcome is BoxOutcome.PLACED and item.X_WB is not None
        )

    def on_table(self) -> tuple[Obstacle, ...]:
        """The box in work where it stands on table B, if it does."""
        item = self.current
        if item.approach is None or item.X_WB is None or item.is_finished:
            return ()
        return (standing_box(item.box, item.X_WB),)

    def lose(self, name: str, reason: str) -> None:
        """Note that a box which was placed no longer stands in its place."""
        next(item for item in self.items if item.name == name).finish(BoxOutcome.LOST, reason)

    def beside(self, item: WorkItem) -> frozenset[str]:
        """Names of the obstacles that a box touches, or nearly touches, at its place."""
        placed = {other.name: other.plan.placed for other in self.items if other.X_WB is not None}
        return neighbours(item.plan.placed, placed)

    def reports(self) -> tuple[BoxReport, ...]:
        """What became of each box."""
        return tuple(
            BoxReport(
                item.name, item.box.dims, item.box.weight, item.handling.value, item.outcome, item.reason,
                item.plan.insertion.direction,
                placed_pose(item.plan.placed, item.box, self._X_WP, item.X_WB),
            )
            for item in self.items
        )  # fmt: skip

    @property
    def _X_WP(self) -> Pose:
        return self._cell.pallet.X_WP


def standing_box(box: OrderBox, X_WB: Pose) -> Obstacle:
    """The obstacle of a box that stands at X_WB."""
    return Obstacle(box.id, X_WB, np.array(box.dims))


def neighbours(placed: PlacedBox, others: Mapping[str, PlacedBox]) -> frozenset[str]:
    """Names of the pallet and of the boxes that are next to a place, over it or under it."""
    near = {name for name, other in others.items() if np.all(placed.clearance(other) < BESIDE)}
    return frozenset(near - {placed.id}) | {PALLET}
