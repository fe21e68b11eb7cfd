"""Where things were a short while ago."""

from __future__ import annotations

import numpy as np
import pytest

from pack_perception.mocap.guided_cell import PoseHistory


@pytest.fixture
def history() -> PoseHistory:
    history = PoseHistory(length=3, nq=2)
    for time in (1.0, 2.0, 3.0, 4.0):
        history.add(time, np.array([10.0 * time, -time]))
    return history


def test_times_between_entries_are_mixed_in_proportion(history: PoseHistory) -> None:
    assert np.allclose(history.at(2.25), [22.5, -2.25])


def test_later_times_get_the_newest(history: PoseHistory) -> None:
    assert np.allclose(history.at(9.0), [40.0, -4.0])


def test_it_forgets_what_is_too_old(history: PoseHistory) -> None:
    assert history.covers(2.0)
    assert not history.covers(1.9)


def test_an_empty_history_covers_nothing() -> None:
    assert not PoseHistory(length=3, nq=2).covers(1e9)


def test_writing_to_later_entries_changes_only_those(history: PoseHistory) -> None:
    history.since(3.0)[:, 0] += 1.0
    assert np.allclose(history.at(4.0), [41.0, -4.0])
    assert np.allclose(history.at(3.0), [30.0, -3.0])


def test_what_is_handed_out_is_a_copy(history: PoseHistory) -> None:
    history.at(4.0)[:] = 0.0
    assert np.allclose(history.at(4.0), [40.0, -4.0])
