"""Answers where a box goes that has just come, by the online planner, from what stands on the pallets."""

from __future__ import annotations

from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.handling import TurnChoice
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import PlannedBox
from pack_core.palletizing.orders.next_place import NextStep, PlaceAnswer, PlaceQuestion
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.online_packer import PackedItem, warm_up
from pack_planner.layout.online_planner import Decision, Floor, OnlineConfig, OnlinePlanner, OpenPallet
from pack_planner.layout.order_proposal import possible_turns
from pack_planner.layout.place_reach import PlaceReach


class PlaceAnswers:
    """Answers questions; it remembers nothing between two of them but what an item's turns are.

    Args:
        cell: the cell, with the places of its pallets.
        config: parameters of the planner; pallets and buffer are those of the question.
        insertion: how the side is chosen from which a box comes.
    """

    def __init__(self, cell: PalletizingCell, config: OnlineConfig, insertion: InsertionConfig) -> None:
        warm_up()
        self._cell, self._config = cell, config
        self._reach = {place: PlaceReach(cell, insertion, place) for place in cell.pallets}
        self._turns: dict[tuple[object, ...], tuple[TurnChoice, ...]] = {}

    def answer(self, question: PlaceQuestion) -> PlaceAnswer:
        """What is done next with the boxes that were set aside and those that have come."""
        items = (*question.buffered, *question.known)
        turns = {item.id: self._turns_of(item) for item in items}
        refused = next((item for item in question.known if not turns[item.id]), None)
        if refused is not None:
            reason = "the gripper cannot hold it in any turn"
            return PlaceAnswer(question.number, NextStep.REJECT, reason, refused.id)
        room = len(question.buffered) + question.room
        config = self._config.model_copy(update={"buffer": room, "pallets": max(1, len(question.pallets))})
        planner = OnlinePlanner(self._cell.pallet.size, turns, config, self._is_reached)
        floor = Floor(tuple(OpenPallet.of(pallet) for pallet in question.pallets), question.buffered)
        return self._worded(question.number, floor, planner.decide(floor, question.known))

    def _worded(self, number: int, floor: Floor, decision: Decision) -> PlaceAnswer:
        item = "" if decision.item is None else decision.item.id
        pallet = None if decision.pallet is None else floor.pallets[decision.pallet]
        place, entry = "" if pallet is None else pallet.place, decision.entry
        if pallet is None or entry is None:
            return PlaceAnswer(number, decision.step, decision.reason, item, place)
        insertion = self._reach[place].insertion(entry.placed, pallet.boxes)
        plan = PlannedBox(entry.placed, insertion)
        return PlaceAnswer(number, decision.step, decision.reason, item, place, plan)

    def _is_reached(self, pallet: OpenPallet, entry: PackedItem) -> bool:
        return self._reach[pallet.place].allows(entry.placed, pallet.boxes)

    def _turns_of(self, item: Item) -> tuple[TurnChoice, ...]:
        key = item.size, item.weight, item.this_side_up
        if key not in self._turns:
            self._turns[key] = tuple(possible_turns((item,), self._cell)[0][item.id])
        return self._turns[key]
