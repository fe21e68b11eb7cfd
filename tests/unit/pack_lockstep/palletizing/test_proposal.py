"""What becomes of a list of items: orders that hold, and reasons for what is in none of them."""

from __future__ import annotations

import pytest

from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import LayoutPlan
from pack_core.palletizing.orders.load_bearing import overloaded_boxes
from pack_core.palletizing.orders.order import Order
from pack_evaluation.palletizing.summary import HOLD_LIMIT_MM
from pack_lockstep.palletizing import proposal
from pack_lockstep.palletizing.proposal import Proposals, propose
from pack_planner.layout.layout_planner import LayoutConfig
from pack_planner.layout.order_proposal import ProposalConfig

CELL = palletizing_cell()


def item(name: str, weight: float = 5.0, **limits: float) -> Item:
    return Item(id=name, article=name, size=(0.4, 0.3, 0.2), weight=weight, this_side_up=False, **limits)


def proposed(items: list[Item]) -> Proposals:
    return propose(items, "list", CELL, ProposalConfig(areas=1, shuffles=0), LayoutConfig())


def test_a_list_becomes_an_order_that_holds() -> None:
    found = proposed([item(f"b{k}") for k in range(4)])
    assert (found.reasons, found.left) == ((), ())
    (pallet,) = found.pallets
    assert len(pallet.order.boxes) == 4
    assert pallet.hold_mm < HOLD_LIMIT_MM
    assert pallet.push >= ProposalConfig().packer.tipping.push


def test_what_no_grip_holds_is_left_with_the_reason_and_the_rest_is_packed() -> None:
    found = proposed([item("anvil", 40.0), item("a"), item("b")])
    assert [box.id for box in found.pallets[0].order.boxes] != []
    assert [one.id for one in found.left] == ["anvil"]
    assert any("box 'anvil': 40 kg" in reason for reason in found.reasons)


def test_orders_keep_what_boxes_may_carry() -> None:
    found = proposed([item(f"b{k}", max_load=0.0) for k in range(12)])
    boxes = [box for pallet in found.pallets for box in pallet.order.boxes]
    assert len(boxes) == 12
    assert {box.max_load for box in boxes} == {0.0}
    for pallet in found.pallets:
        assert overloaded_boxes(pallet.order.placed) == {}


def test_of_a_packing_that_fails_as_a_whole_the_largest_beginning_that_passes_is_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def at_most_three(
        order: Order, cell: PalletizingCell, layout: LayoutConfig
    ) -> tuple[list[str], LayoutPlan | None, float | None]:
        return (["too many"], None, None) if len(order.boxes) > 3 else judge(order, cell, layout)

    judge = proposal.judge
    monkeypatch.setattr(proposal, "judge", at_most_three)
    found = proposed([item(f"b{k}") for k in range(5)])
    assert [len(pallet.order.boxes) for pallet in found.pallets] == [3, 2]
    assert found.reasons == ("list: 3 of 5 packed boxes; with one more: too many",)
    assert found.left == ()


def test_where_all_but_one_box_pass_the_reasons_are_those_against_the_same_packing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second-best packing of each push is tested too, for other reasons."""
    tests: list[int] = []

    def never_whole(
        order: Order, cell: PalletizingCell, layout: LayoutConfig
    ) -> tuple[list[str], LayoutPlan | None, float | None]:
        if len(order.boxes) < 3:
            return judge(order, cell, layout)
        tests.append(len(order.boxes))
        return [f"packing {1 + (len(tests) - 1) % proposal.MOST_TESTS}"], None, None

    judge = proposal.judge
    monkeypatch.setattr(proposal, "judge", never_whole)
    items = [item(f"b{k}") for k in range(3)]
    found = propose(items, "list", CELL, ProposalConfig(areas=2, shuffles=2), LayoutConfig())
    assert len(tests) == proposal.MOST_TESTS * len(proposal.PUSHES)
    assert found.reasons[0] == "list: 2 of 3 packed boxes; with one more: packing 1"
