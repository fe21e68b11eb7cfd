"""A demo says so when the machine could not keep up, and nothing otherwise."""

from __future__ import annotations

import pytest

from pack_bringup.pace import Pace


@pytest.mark.parametrize(
    "pace",
    [
        Pace(1.0),
        Pace(1.0, [0.99, 0.96], [30.0] * 99 + [120.0]),
        Pace(0.25, [0.25], [300.0] * 10),  # of which 75 ms of simulated time pass
        Pace(0.0, [3.0, 2.0], [500.0]),  # as fast as it can: no pace was asked for
    ],
)
def test_a_machine_that_keeps_up_is_not_spoken_of(pace: Pace) -> None:
    assert pace.warning == ""
    assert pace.remark == ""


def test_time_that_ran_too_slowly_is_told_with_what_to_do() -> None:
    pace = Pace(1.0, [0.9, 0.7], [30.0] * 10)
    assert "time ran at 0.80 of real time instead of 1.00. " in pace.warning
    assert "--real-time-factor 0.5)" in pace.warning
    assert pace.remark == " < 1.00"


def test_iterations_that_came_late_are_told() -> None:
    pace = Pace(1.0, [1.0], [30.0] * 9 + [97.0])
    assert "10 % of the iterations took over 96 ms" in pace.warning
    assert "real time instead" not in pace.warning
