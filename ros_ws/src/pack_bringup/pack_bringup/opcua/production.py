"""What a cell does and has done, from the messages that it sends."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar


class Production(ABC):
    """Follows a cell's work; only messages that were sent since the start are given to it.

    Attributes:
        step: what the cell does now, in its own words.
        item: name of what it has in work; empty where nothing is.
        fault: what is not as it should be with this step, in words; empty where all is well.
        message: why the last goal ended as it did, in words.
        placed: how many items were placed.
        pallets: how many pallets or containers were completed.
    """

    items: ClassVar[str]
    """Name of the counter of items."""
    carriers: ClassVar[str]
    """Name of the counter of what items are placed on or in; empty where a cell has no such thing."""
    topics: ClassVar[tuple[str, ...]]
    """What it follows."""

    def __init__(self) -> None:
        self.step = self.item = self.fault = self.message = ""
        self.placed = self.pallets = 0

    @abstractmethod
    def take(self, topic: str, message: Any) -> None:
        """Take a message of one of `topics`."""
