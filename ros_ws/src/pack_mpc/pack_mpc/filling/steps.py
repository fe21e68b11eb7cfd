"""One step of a fill job: what it sees, what it wants, and how it waits.

A job is written down as what it does, one thing after the other, in generators. A generator yields a
`FillCommand` whenever it has to wait, and goes on with the next `FillObservation`. What it waits for is time,
while the arm follows a motion, or the answer to a request that the caller passes to the cell.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias, TypeVar

from pack_core.joints import JointSample, Setpoints
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_mpc.filling.requests import FillRequest

A = TypeVar("A")


class FillStage(Enum):
    """What a fill job does."""

    ARRANGE = "arrange"
    PRESENT = "present"
    PICK = "pick"
    PACK = "pack"
    SET_DOWN = "set_down"
    RELEASE = "release"
    PUT_ASIDE = "put_aside"
    DONE = "done"


@dataclass(frozen=True)
class FillObservation:
    """What a step of the job sees.

    Attributes:
        joints: newest sample of the joints.
        scene: newest estimate of the objects.
        force: newest external force on cup or held object `(3,)` [N].
        is_gripped: whether the pump holds an object: the vacuum is seen.
        answer: the answer to the last request; None while there is none.
    """

    joints: JointSample
    scene: SceneState
    force: Array
    is_gripped: bool
    answer: object | None = None


@dataclass(frozen=True)
class FillCommand:
    """What the caller shall do now.

    Attributes:
        setpoints: what the arm shall follow; None: nothing new, the driver holds it.
        request: to be passed on, once.
    """

    setpoints: Setpoints | None = None
    request: FillRequest | None = None


Steps: TypeAlias = Generator[FillCommand, FillObservation, A]
Until: TypeAlias = Callable[[FillObservation], bool]


def wait(seen: FillObservation, until: Until, longest: float) -> Steps[tuple[bool, FillObservation]]:
    """Wait at most `longest` [s] for a condition, the arm held by the driver; returns whether it came."""
    start = seen.joints.time
    while not until(seen):
        if seen.joints.time - start > longest:
            return False, seen
        seen = yield FillCommand()
    return True, seen


def ask(seen: FillObservation, request: FillRequest, kind: type[A]) -> Steps[tuple[A, FillObservation]]:
    """Pass a request on and wait for its answer."""
    seen = yield FillCommand(request=request)
    while seen.answer is None:
        seen = yield FillCommand()
    assert isinstance(seen.answer, kind), f"{seen.answer!r} does not answer {request!r}"
    return seen.answer, seen
