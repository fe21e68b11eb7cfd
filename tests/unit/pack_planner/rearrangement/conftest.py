"""Problems to plan."""

from collections.abc import Callable

import pytest

from pack_core.blocks.problem import Problem
from pack_planner.rearrangement.planner import warm_up
from unit.problems import make_problem


@pytest.fixture(scope="session", autouse=True)
def compiled() -> None:
    """No test's budget is spent on compiling."""
    warm_up()


@pytest.fixture
def make() -> Callable[..., Problem]:
    """Makes problems from a few numbers."""
    return make_problem


@pytest.fixture
def clock() -> Callable[[], Callable[[], float]]:
    """Makes clocks that go on by a hundredth of a second whenever they are read."""

    def make_clock() -> Callable[[], float]:
        times = iter(range(10**9))
        return lambda: 0.01 * next(times)

    return make_clock
