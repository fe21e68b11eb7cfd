"""Problems to plan."""

from collections.abc import Callable

import pytest

from pack_core.blocks.problem import Problem
from unit.problems import make_problem


@pytest.fixture(scope="session", autouse=True)
def planners(compiled: None) -> None:
    """Planners that need no compiling, for every test of this folder."""


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
