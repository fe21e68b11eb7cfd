"""Time: seconds as float in the cores, nanoseconds as int in bags and messages."""

from __future__ import annotations

NS_PER_S = 1_000_000_000
"""Nanoseconds in a second."""


def to_ns(seconds: float) -> int:
    """Seconds to whole nanoseconds, rounded to the nearest."""
    return round(seconds * NS_PER_S)


def to_seconds(nanoseconds: int) -> float:
    """Whole nanoseconds to seconds."""
    return nanoseconds / NS_PER_S


def split(seconds: float) -> tuple[int, int]:
    """Seconds as `(sec, nanosec)` with `0 <= nanosec < 1e9`, as builtin_interfaces/Time has them."""
    return divmod(to_ns(seconds), NS_PER_S)  # rounds down: times before 0 have nanoseconds from 0 up, too
