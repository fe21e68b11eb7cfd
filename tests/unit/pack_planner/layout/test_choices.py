"""The separator's search over pairs of boxes."""

import inspect
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from pack_planner.layout.axis_program import AxisProgram
from pack_planner.layout.choices import Search

PAIRS = 80


@pytest.fixture
def _few_nested_calls() -> Iterator[None]:
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(len(inspect.stack()) + PAIRS)
    yield
    sys.setrecursionlimit(limit)


@pytest.mark.usefixtures("_few_nested_calls")
def test_more_pairs_are_parted_than_calls_can_be_nested() -> None:
    edge, gap = 0.1, 0.01
    # rows of two boxes that touch, far from each other
    corners = np.array([[i * edge, j * 1.0] for j in range(PAIRS) for i in range(2)])
    count = len(corners)
    programs = [
        AxisProgram(low, low + edge, np.zeros((count, count)), float(PAIRS), gap, 0.0, gap)
        for low in corners.T
    ]
    search = Search(programs, [(k, k + 1) for k in range(0, count, 2)], limit=PAIRS + 1)
    search.run()
    assert search.displacements is not None
    moved = corners[:, 0] + search.displacements[:, 0]
    assert np.diff(moved)[::2] == pytest.approx(edge + gap)
    assert search.tried == PAIRS + 1
