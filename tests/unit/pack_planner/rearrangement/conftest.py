"""Problems to plan."""

from collections.abc import Callable, Mapping

import pytest

from pack_core.rearrangement.planar import PlanarPose
from pack_core.rearrangement.problem import Block, Problem
from pack_planner.rearrangement.instances import square_workspace
from pack_planner.rearrangement.planner import warm_up

Make = Callable[..., Problem]
Rows = Mapping[str, tuple[float, ...]]


@pytest.fixture(scope="session", autouse=True)
def compiled() -> None:
    """No test's budget is spent on compiling."""
    warm_up()


@pytest.fixture
def make() -> Make:
    """A problem from poses x, y [mm] and yaw [rad] by id."""

    def make(starts: Rows, goals: Rows | None = None, size: float = 0.6, **fields: object) -> Problem:
        return Problem(
            blocks=tuple(Block(name, pose(row)) for name, row in starts.items()),
            goals={name: pose(row) for name, row in (goals or starts).items()},
            workspace=square_workspace(size), **fields,
        )  # fmt: skip

    return make


def pose(row: tuple[float, ...]) -> PlanarPose:
    x, y, *yaw = row
    return PlanarPose(1e-3 * x, 1e-3 * y, *yaw)


@pytest.fixture
def clock() -> Callable[[], Callable[[], float]]:
    """Makes clocks that go on by a hundredth of a second whenever they are read."""

    def make_clock() -> Callable[[], float]:
        times = iter(range(10**9))
        return lambda: 0.01 * next(times)

    return make_clock
