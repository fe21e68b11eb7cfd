"""Pacing against a clock that the test turns."""

import pytest

from pack_sim import pacing
from pack_sim.pacing import BURST, CATCH_UP, Pacer


@pytest.fixture
def clock(monkeypatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(pacing.time, "perf_counter", lambda: now[0])
    return now


def test_real_time_waits_out_what_was_simulated(clock) -> None:
    pacer = Pacer(1.0)
    clock[0] += 0.001
    assert pacer.delay(0.004) == pytest.approx(0.003)


def test_half_speed_waits_twice_as_long(clock) -> None:
    assert Pacer(0.5).delay(0.004) == pytest.approx(0.008)


def test_a_factor_of_zero_never_waits(clock) -> None:
    assert Pacer(0.0).delay(0.004) == 0.0


def test_a_short_delay_is_caught_up_with(clock) -> None:
    pacer = Pacer(1.0)
    clock[0] += 0.010
    assert pacer.delay(0.004) == 0.0
    assert pacer.delay(0.010) == pytest.approx(0.004)


def test_a_long_delay_is_given_up(clock) -> None:
    pacer = Pacer(0.1)
    clock[0] += 10.0
    pacer.delay(0.004)
    assert pacer.delay(0.2 * CATCH_UP) == pytest.approx(CATCH_UP)


@pytest.mark.parametrize("factor", [0.5, 1.0, 10.0])
def test_after_a_long_delay_only_a_short_time_is_simulated_in_haste(clock, factor: float) -> None:
    pacer, block = Pacer(factor), 0.001
    clock[0] += 10.0
    blocks = 0
    while pacer.delay(block) == 0.0:
        blocks += 1
    assert blocks * block == pytest.approx(BURST, abs=2 * block)


def test_the_achieved_factor_is_measured_between_calls(clock) -> None:
    pacer = Pacer(1.0)
    for _ in range(10):
        pacer.delay(0.004)
    clock[0] += 0.08
    assert pacer.achieved() == pytest.approx(0.5)
    clock[0] += 1.0
    assert pacer.achieved() == 0.0


def test_another_factor_counts_from_the_next_block_on_and_nothing_is_made_up_for(clock) -> None:
    pacer = Pacer(1.0)
    assert pacer.delay(0.004) == pytest.approx(0.004)
    clock[0] += 0.004
    pacer.change_factor(0.5)
    assert pacer.delay(0.004) == pytest.approx(0.008)
    pacer.change_factor(0.0)
    assert pacer.delay(0.004) == 0.0


def test_a_pause_is_neither_made_up_for_nor_counted(clock) -> None:
    pacer = Pacer(1.0)
    pacer.delay(0.004)
    clock[0] += 60.0
    pacer.skip()
    assert pacer.delay(0.004) == pytest.approx(0.004)
    clock[0] += 0.004
    assert pacer.achieved() == pytest.approx(1.0)
