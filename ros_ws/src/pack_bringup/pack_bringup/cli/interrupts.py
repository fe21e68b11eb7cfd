"""Signals that end a command as Ctrl-C does: what it started is ended, and what it recorded is finished."""

from __future__ import annotations

import signal
from types import FrameType


def end_as_by_ctrl_c(*numbers: signal.Signals) -> None:
    """Have these signals raise KeyboardInterrupt in the main thread, which must be the one that calls."""
    for number in numbers or (signal.SIGTERM,):
        signal.signal(number, _interrupt)


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt
