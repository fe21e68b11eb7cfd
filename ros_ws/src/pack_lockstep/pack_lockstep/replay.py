"""What every replay is: a core is fed what its node received in a recording, and its answers are compared.

`replay` of each cell has the nodes that can be replayed: those whose answers follow from what they receive.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from pack_core.errors import BagError
from pack_core.motion.topics import CAMERA_INFO, IMAGE
from pack_core.ros.messages.conversions import from_stamp
from pack_core.rotations import Array
from pack_evaluation.bag import Bag

EXACT_MM = 1e-6
"""The same input gives the same answer, so only rounding is allowed."""


@dataclass(frozen=True)
class ComparisonRow:
    """The comparison of one output.

    Attributes:
        name: name of the output.
        compared: number of values that were compared.
        mean_mm: mean of their differences.
        difference_mm: the difference that decides: their 95th percentile, or the only one.
        limit_mm: largest allowed difference.
    """

    name: str
    compared: int
    mean_mm: float
    difference_mm: float
    limit_mm: float

    @property
    def agrees(self) -> bool:
        """Whether the difference is within its limit; False if there was nothing to compare."""
        return self.compared > 0 and self.difference_mm <= self.limit_mm


def exact_row(name: str, difference_mm: float) -> ComparisonRow:
    """The row of one answer that has to be the recorded one.

    Args:
        name: of the answer.
        difference_mm: farthest that anything in it is from where it was; inf where it says something else.
    """
    return ComparisonRow(name, 1, difference_mm, difference_mm, EXACT_MM)


@dataclass(frozen=True)
class Replay:
    """The outcome of a replay.

    Attributes:
        node: name of the node whose core was replayed.
        inputs: number of input messages by topic.
        rows: the comparisons.
    """

    node: str
    inputs: dict[str, int]
    rows: tuple[ComparisonRow, ...]

    @property
    def agrees(self) -> bool:
        """Whether the core's outputs agree with the node's recorded ones."""
        return bool(self.rows) and all(row.agrees for row in self.rows)


@dataclass(frozen=True)
class RunConditions:
    """Under which conditions a run was recorded.

    Attributes:
        preset: of the run; empty: the cell's usual one.
        calibration: file of the calibration that the nodes had; empty: none.
        seed: of the goal; None: not known.
        method: of the goal; empty: the usual one.
    """

    preset: str = ""
    calibration: str = ""
    seed: int | None = None
    method: str = ""


class Replayer(Protocol):
    """Replays a node."""

    def __call__(self, bag: Bag, run: RunConditions) -> Replay:
        """Feed the node's core with the recording.

        Raises:
            BagError: the recording lacks what the node received.
            ConfigError: there are no such conditions.
        """


@dataclass(frozen=True)
class Call:
    """A request that a service has answered, as messages, at `time_ns` of simulated time [ns]."""

    time_ns: int
    request: Any
    answer: Any


RECEIVED, SENT = 1, 2
"""Types of a service's events: a request has come, an answer was given (service_msgs/ServiceEventInfo)."""


def calls_in(bag: Bag, topic: str) -> tuple[Call, ...]:
    """What a service was asked and has answered, in order of the answers, from the topic of its events.

    Raises:
        BagError: there is none.
    """
    asked: dict[tuple[bytes, int], Any] = {}
    calls: list[Call] = []
    for item in bag.messages:
        if item.topic != topic:
            continue
        event = item.message
        key = np.asarray(event.info.client_gid).tobytes(), int(event.info.sequence_number)
        if event.info.event_type == RECEIVED and len(event.request):
            asked[key] = event.request[0]
        elif event.info.event_type == SENT and len(event.response) and key in asked:
            calls.append(Call(item.time_ns, asked.pop(key), event.response[0]))
    if not calls:
        raise BagError(f"{bag.path} has no answered request on {topic}: {bag.reason('was it recorded?')}")
    return tuple(calls)


def pictures_in(bag: Bag) -> dict[float, Any]:
    """The camera's pictures by the time of their exposure [s].

    Raises:
        BagError: there are none, or no intrinsics.
    """
    if not bag.of(IMAGE) or not bag.of(CAMERA_INFO):
        raise BagError(
            f"{bag.path} has no pictures with intrinsics ({IMAGE}, {CAMERA_INFO}); the recorder keeps them "
            "with --set recorder.pictures=true"
        )
    return {from_stamp(message.header.stamp): message for message in bag.of(IMAGE)}


def latest(messages: Sequence[Any], time: float) -> Any:
    """The last of some messages that is not stamped later than `time` [s]; the first if all are."""
    earlier = [message for message in messages if from_stamp(message.header.stamp) <= time]
    return (earlier or messages)[-1 if earlier else 0]


def answered(
    bag: Bag, answers: Sequence[Any], pictures: dict[float, Any]
) -> Iterator[tuple[float, Any, Any]]:
    """Time [s], answer and picture of every answer to a picture.

    Raises:
        BagError: the picture of an answer was not recorded.
    """
    for answer in answers:
        time = from_stamp(answer.header.stamp)
        if time not in pictures:
            raise BagError(f"{bag.path} has an answer to the picture of {time:.3f} s, but not that picture")
        yield time, answer, pictures[time]


def farthest_mm(points: Array, others: Array) -> float:
    """The largest distance between points `(..., n, 3)` and others of the same shape [m], in mm."""
    return 1e3 * float(np.linalg.norm(points - others, axis=-1).max(initial=0.0))
