"""What is given up under load: one thing after the other, in order, and taken up again in the reverse one."""

from __future__ import annotations

from itertools import accumulate, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.packing.load_shedding import CALM, IN_TIME, LATE, PAUSE, GivenUp, LoadShedding, given_up

PERIODS = st.lists(st.floats(0.001, 0.45), min_size=1, max_size=60)


def levels_of(periods: list[float]) -> list[GivenUp]:
    return given_up(accumulate([0.0, *periods]))


@given(PERIODS)
def test_things_are_given_up_and_taken_up_again_one_after_the_other(periods: list[float]) -> None:
    levels = levels_of(periods)
    assert levels[0] is GivenUp.NOTHING
    assert all(abs(after - before) <= 1 for before, after in pairwise(levels))


@given(PERIODS)
def test_more_is_given_up_only_by_a_late_iteration(periods: list[float]) -> None:
    levels = levels_of(periods)
    for period, (before, after) in zip(periods, pairwise(levels), strict=True):
        if period > LATE + 1e-9:
            assert after == min(before + 1, GivenUp.ROLLOUTS)
        elif period < LATE - 1e-9:
            assert after <= before


@given(PERIODS)
def test_less_is_given_up_only_after_a_calm_second(periods: list[float]) -> None:
    times = list(accumulate([0.0, *periods]))
    levels = given_up(times)
    for i, (before, after) in enumerate(pairwise(levels), start=1):
        if after < before:
            calm = [j for j in range(1, i + 1) if times[j] > times[i] - CALM + 1e-9]
            assert all(periods[j - 1] < IN_TIME + 1e-9 for j in calm[1:])


@given(PERIODS)
def test_a_machine_that_has_become_quick_gives_up_nothing_in_the_end(periods: list[float]) -> None:
    quick = [0.04] * round((len(GivenUp) + 1) * (CALM + 0.1) / 0.04)
    assert levels_of([*periods, *quick])[-1] is GivenUp.NOTHING


@given(PERIODS, st.integers(0, 59), st.floats(LATE + 1e-6, 0.45))
def test_a_later_iteration_never_makes_less_be_given_up_at_once(
    periods: list[float], index: int, later: float
) -> None:
    index %= len(periods)
    worse = [*periods[:index], max(periods[index], later)]
    assert levels_of(worse)[-1] >= levels_of(periods[: index + 1])[-1]


@given(st.lists(st.floats(IN_TIME + 1e-6, LATE - 1e-6), min_size=1, max_size=60))
def test_between_in_time_and_late_nothing_changes(periods: list[float]) -> None:
    assert levels_of([LATE + 0.01, *periods])[-1] is GivenUp.FRAMES


@pytest.mark.parametrize("pause", [PAUSE, 30.0, -5.0])
def test_a_pause_and_a_clock_that_begins_anew_tell_nothing_of_the_machine(pause: float) -> None:
    load = LoadShedding(GivenUp.SAMPLES, 10.0, 10.0)
    assert load.after(10.0 + pause).level is GivenUp.SAMPLES
    assert load.after(10.0 + pause).after(10.04 + pause).level is GivenUp.SAMPLES


def test_what_is_given_up_is_said_in_its_order() -> None:
    assert not LoadShedding().in_words
    words = LoadShedding(GivenUp.ROLLOUTS).in_words
    assert words.endswith("frames, samples, rehearsals, rollouts")
    assert LoadShedding(GivenUp.REHEARSALS).gives_up(GivenUp.SAMPLES)
    assert not LoadShedding(GivenUp.REHEARSALS).gives_up(GivenUp.ROLLOUTS)
