"""The cell as a fill job has it: what it sees, what it asks for, and what it wants of the arm.

A job is written as steps (`pack_core.tasks.steps`). What they wait for is time, while the arm follows a
motion, or the answer to a request that the caller passes to the cell.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from pack_core.errors import PackError
from pack_core.joints import JointSample, Setpoints
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState
from pack_core.tasks.steps import A, Steps, wait
from pack_mpc.task.task import PackingOutcome

Until: TypeAlias = Callable[[], bool]
"""A condition on what is seen."""


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
class Arrange:
    """Where the remaining objects shall stand, and which comes next; answered by an `Arrangement`.

    Attributes:
        items: the remaining objects, in the list's order.
        planned: where the last arrangement had them, X_WO.
    """

    items: tuple[ObjectModel, ...]
    planned: Mapping[str, Pose]


@dataclass(frozen=True)
class Present:
    """The object is to be handed over; answered by `Presented`."""

    item: ObjectModel


@dataclass(frozen=True)
class Judge:
    """Whether the object that was handed over has a feasible placement; answered by why not, or empty."""


@dataclass(frozen=True)
class UsePump:
    """Close the pump, or open it; answered by the reason why not, empty if it is done."""

    close: bool


@dataclass(frozen=True)
class Pack:
    """Pack the held object; answered by `Packed`.

    Attributes:
        X_WN: where it is wanted; None: wherever it disturbs least.
        grip: X_TN, how it hangs from the cup.
    """

    X_WN: Pose | None
    grip: Pose


FillRequest: TypeAlias = Arrange | Present | Judge | UsePump | Pack


@dataclass(frozen=True)
class Presented:
    """The cell's description with the object handed over, or the reason why it is not."""

    scene: Scene | None
    reason: str = ""


@dataclass(frozen=True)
class Packed:
    """How a packing goal ended, and the packing pose X_WN that it pursued last; None if it had none."""

    outcome: PackingOutcome
    X_WN: Pose | None


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


class FillPort:
    """What a job sees of the cell, and what it has the cell do.

    Attributes:
        seen: the newest observation; whoever steps the job sets it before each step.
        command: what the caller shall do now; taken after each step.
    """

    seen: FillObservation

    def __init__(self) -> None:
        self.command = FillCommand()

    @property
    def time(self) -> float:
        """Of the newest observation [s]."""
        return self.seen.joints.time

    @property
    def q(self) -> Array:
        """Joint positions `(7,)` [rad]."""
        return self.seen.joints.q

    def pose_of(self, name: str) -> Pose:
        """X_WO of an object; raises PackError where perception does not tell it."""
        return self.state_of(name).X_WO

    def state_of(self, name: str) -> ObjectState:
        """Where an object is; raises PackError where perception does not tell it."""
        objects = self.seen.scene.objects
        if name not in objects:
            raise PackError(f"'{name}' is not in the estimate of the scene; there is: {', '.join(objects)}")
        return objects[name]

    def wait(self, until: Until, longest: float) -> Steps[bool]:
        """Wait at most `longest` [s] for a condition, the arm held by the driver; whether it came."""
        return (yield from wait(until, longest, lambda: self.time))

    def ask(self, request: FillRequest, kind: type[A]) -> Steps[A]:
        """Pass a request on and wait for its answer."""
        self.command = FillCommand(request=request)
        yield
        while self.seen.answer is None:
            yield
        assert isinstance(self.seen.answer, kind), f"{self.seen.answer!r} does not answer {request!r}"
        return self.seen.answer
