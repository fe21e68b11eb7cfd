"""Refuses messages that are stamped in the future: all that follows would look old beside them."""

from __future__ import annotations

import math

from pack_core import stamps
from pack_core.errors import MessageError
from pack_core.ros.cell_node import CellNode

AHEAD = 0.5
"""How far a stamp may be ahead of the clock [s]; a tick of /clock may come later than what it stamps."""


class StampCheck:
    """Compares the stamps of one topic with the node's clock, as soon as one leaps ahead of those before it.

    Args:
        node: whose clock counts.
    """

    def __init__(self, node: CellNode) -> None:
        self._node = node
        self._last = -math.inf

    def check(self, time: float) -> None:
        """Look at the stamp of a message [s].

        Raises:
            MessageError: it is in the future.
        """
        # The clock is asked only then, because asking takes longer than most messages do.
        if time > self._last + AHEAD:
            now = stamps.to_seconds(self._node.get_clock().now().nanoseconds)
            if time > now + AHEAD:
                raise MessageError(
                    f"stamped {time:.3f} s, {time - now:.3f} s in the future; allowed: {AHEAD} s ahead of "
                    f"the clock, which is at {now:.3f} s"
                )
        self._last = time
