"""The share of jumps of the force, on forces whose jumps are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pack_evaluation.packing.force import chatter

N = 1000
TIMES = 2.0 + 0.004 * np.arange(N)
FORCES = arrays(float, st.integers(0, 60), elements=st.floats(0.0, 100.0))


def test_a_steady_push_does_not_chatter() -> None:
    assert chatter(TIMES, np.full(N, 12.0)) == 0.0


def test_a_force_that_swings_with_a_period_of_16_ms_chatters_in_every_sample_in_contact() -> None:
    swing = np.where(np.arange(N) % 4 < 2, 12.0, 2.0)
    assert chatter(TIMES, swing) == 1.0


def test_a_force_that_swings_with_a_period_of_8_ms_is_the_same_8_ms_later() -> None:
    assert chatter(TIMES, np.where(np.arange(N) % 2 == 0, 12.0, 2.0)) == 0.0


def test_one_impact_makes_two_samples_of_those_in_contact_jump() -> None:
    force = np.where(np.arange(N) < 400, 0.0, 8.0)
    # samples 400 and 401 have the one 8 ms before still at zero
    assert chatter(TIMES, force) == pytest.approx(2 / 600)


def test_a_fall_to_no_force_is_not_in_contact_and_does_not_count() -> None:
    assert chatter(TIMES, np.where(np.arange(N) < 400, 8.0, 0.0)) == 0.0


def test_a_change_of_just_five_newtons_is_no_jump() -> None:
    assert chatter(TIMES, np.where(np.arange(N) % 4 < 2, 7.0, 2.0)) == 0.0


def test_lockstep_at_every_millisecond_measures_what_a_recording_at_250_hz_does() -> None:
    fast = 2.0 + 0.001 * np.arange(4 * N)
    force = 8.0 + 7.0 * np.sin(2 * np.pi * 20.0 * fast)
    assert chatter(fast, force) == chatter(fast[::4], force[::4]) > 0.0


def test_stamps_that_are_rounded_to_nanoseconds_change_nothing() -> None:
    swing = np.where(np.arange(N) % 4 < 2, 12.0, 2.0)
    assert chatter(np.round(TIMES, 9) + 4e-10, swing) == 1.0


def test_a_lost_message_takes_only_its_own_pairs_along() -> None:
    force = np.full(N, 12.0)
    force[500] = 99.0
    kept = np.arange(N) != 500
    assert chatter(TIMES[kept], force[kept]) == 0.0


@pytest.mark.parametrize("force", [np.zeros(N), np.full(N, 0.9)])
def test_without_contact_there_is_no_share(force: np.ndarray) -> None:
    assert np.isnan(chatter(TIMES, force))


def test_samples_too_far_apart_have_no_share() -> None:
    assert np.isnan(chatter(np.arange(0.0, 1.0, 0.010)[::3], np.full(34, 12.0)))


@given(FORCES)
def test_it_is_a_share_or_nothing(force: np.ndarray) -> None:
    found = chatter(TIMES[: force.size], force)
    assert np.isnan(found) or 0.0 <= found <= 1.0


@given(FORCES, st.floats(0.1, 100.0))
def test_when_it_happened_does_not_matter(force: np.ndarray, later: float) -> None:
    times = TIMES[: force.size]
    np.testing.assert_equal(chatter(times + later, force), chatter(times, force))
