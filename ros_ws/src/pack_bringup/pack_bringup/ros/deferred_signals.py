"""Ctrl-C and SIGTERM wait while rclpy is at work."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

NUMBERS = signal.SIGINT, signal.SIGTERM


@contextmanager
def deferred_signals() -> Iterator[None]:
    """Have these signals take effect when the block is left.

    A handler that raises within a call of rclpy's bindings ends as a TypeError of theirs: they take the
    exception for a value that they cannot convert. In threads other than the main one no handler ever runs.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {number: signal.signal(number, lambda number, _: came.append(number)) for number in NUMBERS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)
