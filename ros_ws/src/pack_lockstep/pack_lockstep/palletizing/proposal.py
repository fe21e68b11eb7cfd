"""Turns a list of items into orders that pass every check, and whose stacks stand when they are pushed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import reasons_against
from pack_core.palletizing.orders.tipping import pushes_of
from pack_evaluation.palletizing.summary import HOLD_LIMIT_MM
from pack_lockstep.palletizing.stack_hold import hold_shift_mm, standing
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner
from pack_planner.layout.online_packer import Packing, Turns
from pack_planner.layout.order_proposal import (
    ProposalConfig,
    order_of,
    packings_of,
    possible_turns,
    ranked,
)

MOST_TESTS = 2
"""Stacks of a pallet that are pushed in physics for each of `PUSHES`, the best first."""
PUSHES = (0.0, 0.1)
"""What boxes must withstand by the closed tipping rule beyond what is configured, one after the other, as
shares of gravity; the more they withstand, the surer the stack holds, and the less it has room for."""


@dataclass(frozen=True)
class Proposal:
    """An order that can be built.

    Attributes:
        order: the order.
        plan: its layout.
        fill: share of the box around the stack that the boxes take up.
        hold_mm: largest shift of a box when the planned stack is pushed with 0.2 g [mm].
        push: horizontal acceleration that every box withstands by the closed tipping rule, as a share of
            gravity.
    """

    order: Order
    plan: LayoutPlan
    fill: float
    hold_mm: float
    push: float


@dataclass(frozen=True)
class Proposals:
    """What became of a list of items.

    Attributes:
        pallets: the orders that can be built, one for each pallet.
        reasons: why items are in none of them, or why a pallet is not as full as packed; empty where all went
            as wanted.
        left: the items that are in no order.
    """

    pallets: tuple[Proposal, ...]
    reasons: tuple[str, ...]
    left: tuple[Item, ...]


def propose(
    items: Sequence[Item], name: str, cell: PalletizingCell, config: ProposalConfig, layout: LayoutConfig,
    on_progress: Callable[[str], None] = lambda text: None,
) -> Proposals:  # fmt: skip
    """Orders for a list of items: one, or as many pallets as they need.

    Args:
        items: what is to be stacked.
        name: id of the order; further pallets have a number behind it.
        cell: the cell that is to build them.
        config: how packings are searched for.
        layout: parameters of the layout planner.
        on_progress: is told what is being done.
    """
    turns, refusals = possible_turns(items, cell)
    found, reasons = list[Proposal](), list(refusals)
    held = [item for item in items if turns[item.id]]
    unheld = [item for item in items if not turns[item.id]]
    while held:
        pallet = name if not found else f"{name}-{len(found) + 1}"
        search = PalletSearch(pallet, turns, cell, config, layout, on_progress)
        proposal, why = search.best_of(held)
        reasons += why
        if proposal is None:
            break
        found.append(proposal)
        placed = {box.id for box in proposal.order.boxes}
        held = [item for item in held if item.id not in placed]
    return Proposals(tuple(found), tuple(reasons), (*unheld, *held))


@dataclass(frozen=True)
class PalletSearch:
    """Searches for the best order of one pallet.

    Attributes:
        name: id of the order.
        turns: the turns that each item may be given, by its id.
        cell: the cell that is to build it.
        config: how packings are searched for.
        layout: parameters of the layout planner.
        on_progress: is told what is being done.
    """

    name: str
    turns: Turns
    cell: PalletizingCell
    config: ProposalConfig
    layout: LayoutConfig
    on_progress: Callable[[str], None]

    def best_of(self, items: Sequence[Item]) -> tuple[Proposal | None, list[str]]:
        """The best order of some of the items, and what speaks against better ones.

        Where no packing passes all checks, as many boxes are left out of the best one, the last placed first,
        as it takes for the rest to pass.
        """
        best: tuple[Packing, list[str]] | None = None
        for more in PUSHES:
            packings = self._packings(items, more)
            for packing in packings[:MOST_TESTS]:
                proposal, refusals = self._judged(packing)
                if proposal is not None:
                    return proposal, []
                if packing is packings[0]:
                    best = packing, refusals
        if best is None:
            return None, [f"{self.name}: none of {len(items)} boxes finds a place on the pallet"]
        return self._begun(*best)

    def _packings(self, items: Sequence[Item], more: float) -> list[Packing]:
        """Packings whose boxes withstand so much more than is configured, the best first."""
        tipping = self.config.packer.tipping
        push = tipping.model_copy(update={"push": tipping.push + more})
        packer = self.config.packer.model_copy(update={"tipping": push})
        config = self.config.model_copy(update={"packer": packer})
        packings, fullest = list[Packing](), 0.0
        for packing in packings_of(items, self.turns, self.cell, config):
            packings.append(packing)
            fullest = max(fullest, packing.fill)
            self.on_progress(f"{self.name}: {len(packings)} packings, fullest {fullest:.0%}")
        return ranked([packing for packing in packings if packing.packed], config.nearly)

    def _begun(self, packing: Packing, refusals: Sequence[str]) -> tuple[Proposal | None, list[str]]:
        """The largest beginning of a packing that passes, found by halving, and why it is not all of it."""
        found: Proposal | None = None
        passes, fails = 0, len(packing.packed)
        while fails - passes > 1:
            count = (passes + fails) // 2
            proposal, why = self._judged(Packing(packing.packed[:count], packing.left))
            if proposal is None:
                fails, refusals = count, why
            else:
                found, passes = proposal, count
        what = f"{self.name}: {passes} of {len(packing.packed)} packed boxes; with one more: "
        return found, [what + "; ".join(refusals)]

    def _judged(self, packing: Packing) -> tuple[Proposal | None, list[str]]:
        """The proposal that a packing makes, or every reason against it."""
        self.on_progress(f"{self.name}: testing {len(packing.packed)} boxes")
        order = order_of(packing, self.name, self.cell)
        refusals, plan, hold_mm = judge(order, self.cell, self.layout)
        if refusals or plan is None or hold_mm is None:
            return None, refusals
        push = min(pushes_of([entry.placed for entry in plan.boxes]).values())
        return Proposal(order, plan, packing.fill, hold_mm, push), []


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
    hold_mm = hold_shift_mm(cell, standing([entry.placed for entry in plan.boxes], cell))
    if hold_mm >= HOLD_LIMIT_MM:
        reasons = [
            f"its stack shifts by {hold_mm:.0f} mm when pushed with 0.2 g; allowed: {HOLD_LIMIT_MM:g} mm"
        ]
    return reasons, plan, hold_mm
