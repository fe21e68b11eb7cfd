"""How work with the cell is written down: as what is done, one thing after the other, in generators."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeAlias, TypeVar

from pack_core.errors import PackError

A = TypeVar("A")
Steps: TypeAlias = Generator[None, None, A]
"""Something that takes time: it goes on with each observation, and returns what it was for."""


class CalibrationFailed(PackError):
    """The calibration cannot be finished; the text says why."""


class TouchInterrupted(CalibrationFailed):
    """The driver held the arm in the middle of a touch: what was felt until then says nothing."""
