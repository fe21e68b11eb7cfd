"""Turns a list of items into orders that pass every check, and whose stacks stand when they are pushed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pack_core.errors import OrderError
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import reasons_against
from pack_core.rotations import Pose
from pack_evaluation.palletizing.summary import HOLD_LIMIT_MM
from pack_lockstep.palletizing.stack_hold import hold_shift_mm
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pack_planner.layout.online_packer import Packing
from pack_planner.layout.order_proposal import ProposalConfig, order_of, packings_of, ranked

MOST_TESTS = 10
"""Packings that are tested for one pallet, the best first."""


@dataclass(frozen=True)
class Proposal:
    """An order that can be built.

    Attributes:
        order: the order.
        plan: its layout.
        fill: share of the box around the stack that the boxes take up.
        hold_mm: largest shift of a box when the planned stack is pushed with 0.2 g [mm].
    """

    order: Order
    plan: LayoutPlan
    fill: float
    hold_mm: float


def propose(
    items: Sequence[Item], name: str, cell: PalletizingCell, config: ProposalConfig, layout: LayoutConfig,
    on_progress: Callable[[str], None] = lambda text: None,
) -> list[Proposal]:  # fmt: skip
    """Orders for all items: one, or as many pallets as they need.

    Args:
        items: what is to be stacked.
        name: id of the order; further pallets have a number behind it.
        cell: the cell that is to build them.
        config: how packings are searched for.
        layout: parameters of the layout planner.
        on_progress: is told what is being done.

    Raises:
        OrderError: an item cannot be held, or no packing passes all checks.
    """
    proposals: list[Proposal] = []
    left = list(items)
    while left:
        number = len(proposals) + 1
        found, left = _one_pallet(left, name if number == 1 else f"{name}-{number}", cell, config, layout,
                                  on_progress)  # fmt: skip
        proposals.append(found)
    return proposals


def _one_pallet(
    items: Sequence[Item], name: str, cell: PalletizingCell, config: ProposalConfig, layout: LayoutConfig,
    on_progress: Callable[[str], None],
) -> tuple[Proposal, list[Item]]:  # fmt: skip
    """The best packing that passes every check, and the items that found no place in it."""
    packings: list[Packing] = []
    for packing in packings_of(items, cell, config):
        packings.append(packing)
        on_progress(f"{name}: {len(packings)} packings, fullest {max(entry.fill for entry in packings):.0%}")
    packings = ranked([packing for packing in packings if packing.packed], config.nearly)
    refusals = ["no item fits on the pallet"]
    for tried, packing in enumerate(packings[:MOST_TESTS], start=1):
        on_progress(f"{name}: testing packing {tried}")
        order = order_of(packing, name, cell)
        refusals, plan, hold_mm = judge(order, cell, layout)
        if not refusals and plan is not None and hold_mm is not None:
            return Proposal(order, plan, packing.fill, hold_mm), list(packing.left)
    raise OrderError(
        "\n".join([f"{name}: no packing of {len(items)} boxes passes; the last one:", *refusals])
    )


def judge(
    order: Order, cell: PalletizingCell, layout: LayoutConfig
) -> tuple[list[str], LayoutPlan | None, float | None]:
    """Every reason against an order, its layout, and how far its stack shifts under 0.2 g [mm].

    What depends on a step that failed is None.
    """
    reasons = reasons_against(order, layout.support, cell)
    if reasons:
        return reasons, None, None
    plan = LayoutPlanner(layout).plan(order)
    if plan.status is not LayoutStatus.SUCCESS:
        return [plan.reason], None, None
    hold_mm = hold_shift_mm(cell, planned_stack(plan, cell))
    if hold_mm >= HOLD_LIMIT_MM:
        reasons = [
            f"its stack shifts by {hold_mm:.0f} mm when pushed with 0.2 g; allowed: {HOLD_LIMIT_MM:g} mm"
        ]
    return reasons, plan, hold_mm


def planned_stack(plan: LayoutPlan, cell: PalletizingCell) -> dict[BoxBody, Pose]:
    """The boxes of a plan as bodies at their places; their own axes are those of the pallet."""
    stack = {}
    for entry in plan.boxes:
        x, y, z = (float(edge) for edge in entry.placed.size)
        body = BoxBody(entry.placed.id, (x, y, z), entry.placed.mass)
        stack[body] = Pose(cell.pallet.X_WP.apply(entry.placed.centre), cell.pallet.X_WP.q)
    return stack
