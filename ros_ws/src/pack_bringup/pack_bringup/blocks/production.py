"""What the blocks cell does and has done, from its executor's status."""

from __future__ import annotations

from typing import Any

from pack_bringup.opcua.production import Production
from pack_core.blocks import topics
from pack_core.text.json_text import parse_json


class BlocksProduction(Production):
    """Blocks count when they are put down or pushed; nothing carries them away."""

    items, carriers = "Blocks", ""
    topics = (topics.STATUS, topics.RESULT)

    def __init__(self) -> None:
        super().__init__()
        self._moved = 0

    def take(self, topic: str, message: Any) -> None:
        """Take the executor's status, or how a goal ended."""
        if topic == topics.RESULT:
            self.message = str(parse_json(message.data, topic)["message"])
            return
        self.step, self.item = message.phase, message.block
        moved = message.picks + message.pushes
        # Both are counted anew for each goal.
        self.placed += moved - self._moved if moved >= self._moved else moved
        self._moved = moved


PRODUCTION = BlocksProduction
"""For the register of cells."""
