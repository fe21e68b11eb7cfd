"""Takes one goal out of a recording that holds several."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from pack_core import stamps
from pack_core.errors import BagError
from pack_evaluation.bag import Bag, Recorded


@dataclass(frozen=True)
class GoalNumber:
    """Which goal of a recording this is.

    Attributes:
        number: counted from 1 in order of time.
        count: how many goals the recording holds.
    """

    number: int = 1
    count: int = 1

    def __str__(self) -> str:
        return f"{self.number} of {self.count}"


PAUSE = stamps.to_ns(0.5)
"""Time without any message that is no lost message, but a pause of the recording [ns of simulated time]."""
ONLY_GOAL = GoalNumber()
"""Of a run that is not one of several."""


@dataclass(frozen=True, kw_only=True)
class RecordedRun:
    """A goal's run as arrays: what every cell's says of its recording; by default it comes from none.

    Attributes:
        is_cut: whether the recording ended before the run did.
        damaged: number of pieces of the recording that could not be read.
        notes: which of its files and topics are missing or were left out, and why.
        goal: which goal of its recording it is.
    """

    is_cut: bool = False
    damaged: int = 0
    notes: tuple[str, ...] = ()
    goal: GoalNumber = ONLY_GOAL


def goal_of(
    bag: Bag,
    number: int | None,
    *,
    result: str,
    needed: Collection[str] = (),
    latched: Collection[str] = (),
    has_begun: Callable[[Sequence[Recorded]], bool] = lambda _: False,
) -> tuple[Bag, GoalNumber]:
    """The part of a recording that belongs to one goal.

    A goal ends with its result, and what follows belongs to the next. After the last result all is kept.

    Args:
        bag: the recording.
        number: which goal, from 1 in order of time; None: the last.
        result: topic on which a goal's end is published.
        needed: topics that every goal has.
        latched: topics whose newest message from before the goal belongs to it, too.
        has_begun: whether what was recorded after the last result shows a goal without an end.

    Raises:
        BagError: there is no goal of this number, or it has no message on a topic that every goal has.
    """
    parts = _parts(bag.messages, result, latched, has_begun)
    wanted = len(parts) if number is None else number
    if not 1 <= wanted <= len(parts):
        held = f"it holds {len(parts)}, numbered from 1 in order of time"
        raise BagError(f"{bag.path} has no goal {wanted}; {held}")
    start, end = parts[wanted - 1]
    earlier = {item.topic: item for item in bag.messages[:start] if item.topic in latched}
    messages = (*earlier.values(), *bag.messages[start:end])
    found, goal = replace(bag, messages=messages), GoalNumber(wanted, len(parts))
    if missing := [topic for topic in needed if not found.of(topic)]:
        lacks = f"goal {goal} has no message on {', '.join(missing)}"
        reason = bag.reason("was the node that sends it running? Did the goal run to its end?")
        raise BagError(f"{bag.path}: {lacks}: {reason}")
    return found, goal


def without_earlier_gaps(bag: Bag, start: float, *, latched: Collection[str] = ()) -> Bag:
    """What was recorded without a pause until a goal began, and everything since then.

    Where only goals are recorded, nothing is between two of them: time jumps from one message to the next.

    Args:
        bag: the recording.
        start: when the goal began [s of simulated time].
        latched: topics whose newest message from before the pause is kept, too.
    """
    begins = stamps.to_ns(start)
    places = [
        place
        for place, (item, following) in enumerate(pairwise(bag.messages), 1)
        if following.time_ns <= begins and following.time_ns - item.time_ns > PAUSE
    ]
    first = places[-1] if places else 0
    earlier = {item.topic: item for item in bag.messages[:first] if item.topic in latched}
    return replace(bag, messages=(*earlier.values(), *bag.messages[first:]))


def _parts(
    messages: Sequence[Recorded],
    result: str,
    latched: Collection[str],
    has_begun: Callable[[Sequence[Recorded]], bool],
) -> list[tuple[int, int]]:
    """First and last place of each goal's messages, the last excluded."""
    ends = [place + 1 for place, item in enumerate(messages) if item.topic == result]
    parts = [
        (start, end)
        for start, end in zip([0, *ends], ends, strict=False)
        # The result of a goal before the recording began, latched, stands alone.
        if any(item.topic != result and item.topic not in latched for item in messages[start:end])
    ]
    last = parts[-1][1] if parts else 0
    if parts and not has_begun(messages[last:]):
        parts[-1] = (parts[-1][0], len(messages))
    else:
        parts.append((last, len(messages)))
    return parts
