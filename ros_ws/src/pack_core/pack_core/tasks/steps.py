"""A task as what is done, one thing after the other, in generators.

A generator yields wherever it has to wait, and goes on with the next look at the cell: a message in a node, a
cycle in lockstep. It calls nobody and owns no clock. What it may look at, and what it has the cell do, is an
object of the cell's own, which has the newest observation before every look:

    def take_hold(self) -> Steps[None]:
        self.commands.append(CloseGripper())
        if not (yield from wait(lambda: self.seen.grip.is_closed, 2.0, self.clock)):
            raise PackError("the gripper holds nothing")
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Generic, Protocol, TypeAlias, TypeVar

from pack_core.errors import PackError

A = TypeVar("A")
Steps: TypeAlias = Generator[None, None, A]
"""Something that takes time: it goes on with each look, and returns what it was for."""
Clock: TypeAlias = Callable[[], float]
"""The present time [s]."""


class Pending(Protocol):
    """What has been asked of a service; a future of rclpy is one."""

    def done(self) -> bool:
        """Whether it was answered."""
        ...

    def result(self) -> object:
        """The answer."""
        ...


def wait(until: Callable[[], object], longest: float, clock: Clock) -> Steps[bool]:
    """Wait for a condition; returns whether it came to hold within `longest` [s]."""
    start = clock()
    while not until():
        if clock() - start > longest:
            return False
        yield
    return True


def ask(pending: Pending, longest: float, clock: Clock) -> Steps[object]:
    """The answer to what was asked; raises PackError where none comes within `longest` [s]."""
    if not (yield from wait(pending.done, longest, clock)):
        raise PackError(f"no answer within {longest:.0f} s")
    return pending.result()


class TaskRun(Generic[A]):
    """Carries out steps, look by look, and keeps what came of them.

    Args:
        steps: what is to be done.

    Attributes:
        is_over: whether it has ended, one way or the other.
        outcome: what the steps returned; None before their end, and where they failed.
        failure: why they failed, in words; empty while they did not.
    """

    def __init__(self, steps: Steps[A]) -> None:
        self._steps = steps
        self.is_over = False
        self.outcome: A | None = None
        self.failure = ""

    def go_on(self) -> None:
        """Go as far as what is known now allows; does nothing after the end.

        What is not foreseen in the steps ends the task, too, and is raised.
        """
        if self.is_over:
            return
        try:
            next(self._steps)
        except StopIteration as end:
            self.outcome, self.is_over = end.value, True
        except PackError as error:
            self.fail(str(error))
        except Exception as error:
            self.fail(repr(error))  # else the next look would find steps that have ended well
            raise

    def fail(self, reason: str) -> None:
        """End the task for a reason; does nothing after the end."""
        if not self.is_over:
            self.failure, self.is_over = reason, True
