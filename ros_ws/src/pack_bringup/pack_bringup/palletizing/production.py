"""What the palletizing cell does and has done, from the states that its machine enters."""

from __future__ import annotations

from typing import Any

from pack_bringup.opcua.production import Production
from pack_core.palletizing import topics
from pack_core.palletizing.cell import PALLETS
from pack_core.text.json_text import parse_json
from pallet_fsm.states import State


class PalletizingProduction(Production):
    """Boxes count once they are let go on the pallet, pallets once they are complete or taken away."""

    items, carriers = "Boxes", "Pallets"
    topics = (topics.PALLET_STATE, topics.RESULT, topics.PALLET_PLACES)

    def __init__(self) -> None:
        super().__init__()
        self._away: set[str] = set()

    def take(self, topic: str, message: Any) -> None:
        """Take a state, an order's report, or the places from which pallets are taken."""
        if topic == topics.PALLET_STATE:
            self._enter(message)
        elif topic == topics.RESULT:
            report = parse_json(message.data, topic)
            self.message = str(report["reason"])
            self.pallets += bool(report["is_complete"])
        else:
            away = set(message.away)
            self.pallets += len(away - self._away)
            self._away = away

    def _enter(self, message: Any) -> None:
        # The arm retreats, too, from boxes that it has put back or could not take, or has set aside.
        was_set_down = self.step == State.DEPOSIT.label and message.state == State.RETREAT.label
        self.placed += was_set_down and message.place in PALLETS
        self.step, self.item, self.fault = message.state, message.box, message.reason


PRODUCTION = PalletizingProduction
"""For the register of cells."""
