"""Curves over the last seconds of simulated time."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence

import numpy as np
from viser import GuiApi, uplot

from pack_viewer.fragments import BLUE, GREEN, GREY, ORANGE, PURPLE, RED

COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE)
PERIOD = 0.1
"""Least simulated time between two points of a curve [s]."""
KEPT = 600
"""Points of a curve; at ten a second they are a minute."""
SEND_PERIOD = 0.5
"""Least time between two pictures of a plot [s of wall clock]: each carries all of its points."""
HEIGHT = 150
"""Of a plot [pixel]."""
PADDING = (10, 24, 0, 0)
"""Room above and to the right of the curves [pixel], without which the last labels of the axes are cut."""

TICKS = tuple(float(f"{digit}e{power}") for power in range(-3, 10) for digit in (1, 2, 5))
"""Distances between two ticks of an axis: labels have three decimals, and closer ticks would all be "0"."""


class RollingPlot:
    """A plot to which points are added as time goes on, and which is sent when it is asked to.

    Args:
        gui: where it is added, within the container that is open.
        title: what is plotted, with its unit.
        curves: name of each curve.
        period: points that come sooner after the last one are left out [s of simulated time].
    """

    def __init__(self, gui: GuiApi, title: str, curves: Sequence[str], period: float = PERIOD) -> None:
        self._rows: deque[tuple[float, ...]] = deque(maxlen=KEPT)
        self._width, self._changed, self._period = len(curves) + 1, False, period
        self._next_send = 0.0
        series: list[uplot.Series] = [uplot.Series(label="time [s]")]
        series += [
            uplot.Series(label=name, stroke=colour, width=2)
            for name, colour in zip(curves, COLOURS, strict=False)
        ]
        axis = uplot.Axis(stroke=GREY, grid={"stroke": f"{GREY}40", "width": 1}, incrs=TICKS)
        self._handle = gui.add_uplot(
            self._data(), tuple(series), title=title, height=HEIGHT, axes=(axis, axis),
            scales={"x": uplot.Scale(time=False, auto=True), "y": uplot.Scale(auto=True)}, padding=PADDING,
        )  # fmt: skip

    @property
    def points(self) -> np.ndarray:
        """Times and values `(n, 1 + curves)`, oldest first."""
        return np.array(self._rows, dtype=float).reshape(-1, self._width)

    def add(self, at: float, *values: float) -> None:
        """Add a point to every curve at simulated time `at` [s]; NaN leaves a gap."""
        if self._rows and at < self._rows[-1][0] + self._period:
            return
        self._rows.append((at, *values))
        self._changed = True

    def clear(self) -> None:
        """Forget all points."""
        self._rows.clear()
        self._changed = True

    def set_visible(self, visible: bool) -> None:
        """Show or hide it."""
        if self._handle.visible != visible:
            self._handle.visible = visible

    def send(self) -> None:
        """Show what was added, unless it was shown a moment ago."""
        if self._changed and (now := time.monotonic()) >= self._next_send:
            self._handle.data = self._data()
            self._changed, self._next_send = False, now + SEND_PERIOD

    def _data(self) -> tuple[np.ndarray, ...]:
        # Without any point the browser gives the axis of time no range, and keeps it so.
        nothing = [(moment, *([np.nan] * (self._width - 1))) for moment in (0.0, 1.0)]
        rows = np.array(self._rows or nothing, dtype=float).reshape(-1, self._width)
        return tuple(np.ascontiguousarray(column) for column in rows.T)
