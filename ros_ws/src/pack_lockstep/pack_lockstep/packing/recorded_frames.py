"""What a replay of the packing cell needs of a recording: that hardly a message is missing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pack_core.errors import BagError
from pack_core.rotations import Array
from pack_evaluation.bag import Bag

MAX_MISSING = 0.01
"""Share of a topic's messages that a recording may lack; with fewer, a replay is meaningless."""
SAME = 1e-6
"""Times that differ by less are of the same scene [s]."""


def check_frames(bag: Bag, topic: str, stamps: Sequence[float], rate: float | None = None) -> int:
    """Count a topic's messages before anything is scored.

    Args:
        bag: the recording, for its name in errors.
        topic: topic of the messages.
        stamps: stamps of the messages [s], in order.
        rate: least rate of the topic [Hz]; None for a periodic topic, whose rate follows from its stamps.

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
    """Number of messages that a periodic topic should have between its first and its last one.

    The period is the mean of the gaps in which no message is missing. It is the mean, not the median, because
    stamps are whole milliseconds.
    """
    gaps = np.diff(stamps)
    period = float(gaps[gaps < 1.5 * np.median(gaps)].mean())
    return 1 + int(np.maximum(np.round(gaps / period), 1.0).sum())
