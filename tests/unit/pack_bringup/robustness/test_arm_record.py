"""When an arm began to brake and when it stood, from its speeds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pack_bringup.robustness.arm_record import ArmRecord, stop_of

STAMPS = np.arange(0.0, 2.0, 0.002)


def speeds(brakes: float, stands: float, after: float = 0.0, resumes: float = math.inf) -> np.ndarray:
    """Cruising at 1 rad/s, down in a line to zero, and `after` rad/s from a later moment on."""
    falling = np.clip((stands - STAMPS) / (stands - brakes), 0.0, 1.0)
    return np.where(resumes < STAMPS, after, falling)


def test_braking_and_standing_are_told_from_the_fault_on() -> None:
    rows = STAMPS >= 0.5
    stop = stop_of(STAMPS[rows], speeds(0.6, 1.0)[rows], 0.5)
    assert stop.brakes_after == pytest.approx(0.1, abs=0.02)
    assert stop.stands_after == pytest.approx(0.5, abs=0.03)


def test_what_the_arm_does_after_it_stood_is_another_move() -> None:
    stop = stop_of(STAMPS, speeds(0.2, 0.4, after=2.0, resumes=1.0), 0.0)
    assert stop.brakes_after == pytest.approx(0.2, abs=0.02)
    assert stop.stands_after == pytest.approx(0.4, abs=0.02)


def test_an_arm_that_goes_on_never_stands_and_one_that_stood_had_nothing_to_brake() -> None:
    assert stop_of(STAMPS, np.ones_like(STAMPS), 0.0).stands_after == math.inf
    assert math.isnan(stop_of(STAMPS, np.zeros_like(STAMPS), 0.0).stands_after)


def test_an_arm_that_gathers_speed_brakes_once_it_gathers_less() -> None:
    """Acceleration of 5 rad/s^2 until 0.03 s, then down with 100 rad/s^3 to -5 and back."""
    stamps = np.arange(0.0, 0.6, 0.004)
    rise = np.interp(stamps, [0.0, 0.03, 0.13, 0.2, 0.25], [5.0, 5.0, -5.0, -5.0, 0.0])
    gathered = np.maximum(0.0, 0.3 + np.cumsum(rise) * 0.004)
    stop = stop_of(stamps, np.where(stamps > 0.25, 0.0, gathered), 0.0)
    assert stop.brakes_after == pytest.approx(0.035, abs=0.008)
    assert gathered.argmax() * 0.004 > 0.07


def test_a_record_begins_anew_with_the_time_of_another_simulator() -> None:
    record = ArmRecord()
    for stamp in (40.0, 40.1, 0.1, 0.2):
        record.add(stamp, 5, 1.0)
    assert record.simulated(10) == 0.2
    assert len(record.between(0.0, 50.0)) == 2


def test_a_moment_of_the_wall_clock_is_told_in_simulated_time_by_what_was_sent_before_it() -> None:
    record = ArmRecord()
    for k in range(10):
        record.add(0.1 * k, 1000 * k, 1.0)
    assert record.simulated(4500) == pytest.approx(0.4)
    assert record.speed == 1.0
    assert not record.is_at_rest()


def test_a_record_tells_how_old_it_is_and_how_fast_the_arm_was_at_a_moment() -> None:
    record = ArmRecord()
    assert record.age(0) == math.inf
    assert math.isnan(record.speed_at(1.0))
    for k in range(3):
        record.add(0.1 * k, 10_000_000 * k, 1.0 - 0.4 * k)
    assert record.age(50_000_000) == pytest.approx(0.03)
    assert record.speed_at(0.15) == pytest.approx(0.6)
