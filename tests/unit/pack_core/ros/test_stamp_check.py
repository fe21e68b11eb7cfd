"""Stamps in the future are refused; time may begin anew, and a node without simulated time refuses none."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from pack_core.errors import MessageError
from pack_core.ros.clock import AHEAD, StampCheck
from pack_core.ros.node import CellNode


class Clock:
    """Stands in for a node with a clock."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds

    def get_clock(self) -> Any:
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=round(self.seconds * 1e9)))


def check_with(clock: Clock) -> StampCheck:
    return StampCheck(cast(CellNode, clock))


def test_a_stamp_in_the_future_is_refused_and_those_after_it_are_taken() -> None:
    clock = Clock(10.0)
    check = check_with(clock)
    check.check(10.004)
    with pytest.raises(MessageError, match=r"stamped 1010\.000 s, 1000\.000 s in the future"):
        check.check(1010.0)
    check.check(10.008)


def test_stamps_may_leap_when_the_clock_did_and_begin_anew() -> None:
    clock = Clock(10.0)
    check = check_with(clock)
    check.check(10.0)
    clock.seconds = 500.0
    check.check(500.0 + 0.9 * AHEAD)
    check.check(0.0)
    check.check(0.004)
