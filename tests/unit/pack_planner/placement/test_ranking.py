"""In which order placements are considered."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pack_planner.placement.least_disturbance_planner import cheapest_elsewhere, distances_to, spread_out

PLACES = st.lists(st.tuples(st.floats(0.0, 0.3), st.floats(0.0, 0.2)), min_size=1, max_size=30)


def at(places: list[tuple[float, float]]) -> np.ndarray:
    return np.pad(np.array(places), ((0, 0), (0, 5)))


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
def test_with_nothing_to_avoid_they_come_by_cost(costs: list[float]) -> None:
    order = cheapest_elsewhere(np.array(costs), np.zeros((len(costs), 7)), [], 0.1)
    assert [costs[k] for k in order] == sorted(costs)


@given(PLACES, PLACES)
def test_what_is_near_places_tried_is_left_out(
    places: list[tuple[float, float]], tried: list[tuple[float, float]]
) -> None:
    poses, avoid = at(places), at(tried)[:, :3]
    distances = np.linalg.norm(poses[:, None, :2] - avoid[None, :, :2], axis=-1).min(axis=1)
    found = cheapest_elsewhere(np.zeros(len(poses)), poses, list(avoid), 0.05)
    if np.any(distances >= 0.05):
        assert sorted(found.tolist()) == np.flatnonzero(distances >= 0.05).tolist()
    else:
        assert distances[found].tolist() == [distances.max()]


@given(PLACES, st.integers(1, 30))
def test_those_come_first_that_keep_apart_and_have_the_others_near_them(
    places: list[tuple[float, float]], n: int
) -> None:
    poses, spacing = at(places), 0.05
    chosen = spread_out(np.arange(len(poses)), poses, spacing, n)
    assert chosen[0] == 0
    assert len(set(chosen)) == len(chosen) == min(n, len(poses))
    apart = np.linalg.norm(poses[:, None, :2] - poses[None, chosen, :2], axis=-1)
    is_near = [np.any(apart[k, :i] <= spacing) for i, k in enumerate(chosen)]
    first = is_near.index(True) if any(is_near) else len(chosen)
    assert first == n or np.all(apart[:, :first].min(axis=1) <= spacing)


def test_without_places_to_avoid_all_are_infinitely_far() -> None:
    assert distances_to(np.zeros((3, 7)), []).tolist() == [np.inf] * 3
