"""Steps of a task: waiting, asking, and what becomes of them."""

import pytest

from pack_core.errors import PackError
from pack_core.tasks.steps import Steps, TaskRun, ask, wait


class Cell:
    """A clock, and something that comes to hold at a time."""

    def __init__(self, at: float) -> None:
        self.time, self._at = 0.0, at

    def done(self) -> bool:
        return self.time >= self._at

    def result(self) -> str:
        return "answer"

    def run(self, steps: Steps[object], until: float = 10.0) -> TaskRun[object]:
        run = TaskRun(steps)
        while not run.is_over and self.time < until:
            run.go_on()
            self.time += 1.0
        return run


def test_waiting_ends_as_soon_as_a_condition_holds_or_its_time_is_up() -> None:
    for at, outcome, time in ((0.0, True, 1.0), (2.0, True, 3.0), (9.0, False, 5.0)):
        cell = Cell(at)
        assert cell.run(wait(cell.done, 3.0, lambda cell=cell: cell.time)).outcome is outcome
        assert cell.time == time


def test_what_is_asked_is_answered_or_fails_in_words() -> None:
    cell = Cell(2.0)
    assert cell.run(ask(cell, 3.0, lambda: cell.time)).outcome == "answer"
    cell = Cell(9.0)
    run = cell.run(ask(cell, 3.0, lambda: cell.time))
    assert (run.outcome, run.failure) == (None, "no answer within 3 s")


def test_a_task_that_breaks_has_failed_and_not_ended_well() -> None:
    def steps() -> Steps[str]:
        yield
        raise KeyError("tin")

    run = TaskRun(steps())
    run.go_on()
    with pytest.raises(KeyError):
        run.go_on()
    run.go_on()
    assert (run.is_over, run.outcome, run.failure) == (True, None, "KeyError('tin')")


def test_a_task_that_has_ended_does_nothing_more_and_keeps_its_first_reason() -> None:
    def steps() -> Steps[None]:
        yield
        raise PackError("cannot go on")

    run = TaskRun(steps())
    run.go_on()
    assert not run.is_over
    run.go_on()
    run.fail("another reason")
    run.go_on()
    assert (run.is_over, run.failure) == (True, "cannot go on")
