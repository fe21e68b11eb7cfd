"""When an arm began to brake and when it stood, from its speeds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pack_bringup.faults.arm_record import ArmRecord, stop_of

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


def test_a_moment_of_the_wall_clock_is_told_in_simulated_time_by_what_was_sent_before_it() -> None:
    record = ArmRecord()
    for k in range(10):
        record.add(0.1 * k, 1000 * k, 1.0)
    assert record.simulated(4500) == pytest.approx(0.4)
    assert record.speed == 1.0
    assert not record.is_at_rest()
