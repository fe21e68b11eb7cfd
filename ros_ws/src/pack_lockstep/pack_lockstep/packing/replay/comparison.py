"""What a replay found: how much was fed in, and how far the core's answers are from the recorded ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.errors import BagError
from pack_core.rotations import Array
from pack_evaluation.bag import Bag

MAX_MISSING = 0.01
"""Share of a topic's messages that a recording may lack; beyond it no score is worth anything."""


@dataclass(frozen=True)
class ComparisonRow:
    """One thing compared.

    Attributes:
        name: of it.
        compared: how many values.
        mean_mm: mean of their differences.
        difference_mm: what is judged: their 95th percentile, or the only one.
        limit_mm: what it may be at most.
    """

    name: str
    compared: int
    mean_mm: float
    difference_mm: float
    limit_mm: float

    @property
    def agrees(self) -> bool:
        """Whether the difference is within its limit; not when there was nothing to compare."""
        return self.compared > 0 and self.difference_mm <= self.limit_mm


@dataclass(frozen=True)
class Replay:
    """The outcome of a replay.

    Attributes:
        node: whose core it was.
        inputs: messages fed in by topic.
        rows: what was compared.
    """

    node: str
    inputs: dict[str, int]
    rows: tuple[ComparisonRow, ...]

    @property
    def agrees(self) -> bool:
        """Whether the core does what the node did."""
        return bool(self.rows) and all(row.agrees for row in self.rows)


def check_frames(bag: Bag, topic: str, stamps: Sequence[float], rate: float | None = None) -> int:
    """Count a topic's messages before anything is scored.

    Args:
        bag: the recording, for its name in errors.
        topic: of the messages.
        stamps: theirs [s], in order.
        rate: that the topic has at least [Hz]; None where it is periodic and tells its rate itself.

    Returns:
        The count.

    Raises:
        BagError: more than `MAX_MISSING` of the messages are missing, or all.
    """
    count = len(stamps)
    if count < 2:
        raise BagError(f"{bag.path} has {count} messages on {topic}: was it recorded?")
    expected = expected_count(np.asarray(stamps)) if rate is None else round((stamps[-1] - stamps[0]) * rate)
    if count < (1.0 - MAX_MISSING) * expected:
        allowed = f"at least {100 * (1 - MAX_MISSING):.0f} %"
        raise BagError(f"{bag.path} has {count} of {expected} messages on {topic}; a replay needs {allowed}")
    return count


def expected_count(stamps: Array) -> int:
    """Messages that a periodic topic has between its first and its last, were none missing.

    The period is the mean of those gaps that are no longer than usual; stamps are whole milliseconds.
    """
    gaps = np.diff(stamps)
    period = float(gaps[gaps < 1.5 * np.median(gaps)].mean())
    return 1 + int(np.maximum(np.round(gaps / period), 1.0).sum())
