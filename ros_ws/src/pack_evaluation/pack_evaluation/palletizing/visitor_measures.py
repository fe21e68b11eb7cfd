"""What visitors meant for a run: how near they came, and what the arm did about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.palletizing.state_times import tool_speeds

CROSSING = 1.0
"""A visitor that comes nearer to the arm than this makes a crossing [m]; it ends when it is farther again."""
KEPT = 0.1
"""Distance that is to be kept [m]."""
STANDS = 0.02
"""Speed below which the tool stands [m/s]."""


@dataclass(frozen=True)
class VisitorMeasures:
    """Visitors in a run.

    Attributes:
        crossings: how often a visitor came near the arm.
        least_m: the least true distance in each crossing, from the arm or what it carries [m].
        near_s: time in which a visitor was near [s].
        stopped_s: part of it in which the tool stood [s].
        too_near: crossings with less than the distance that is to be kept.
        touches: unwanted contacts with a visitor.
    """

    crossings: int
    least_m: tuple[float, ...]
    near_s: float
    stopped_s: float
    too_near: int
    touches: int


def measure_visitors(run: PalletRun) -> VisitorMeasures | None:
    """The measures of a run's visitors; None where there were none."""
    if not run.visitors:
        return None
    least: list[float] = []
    near_s = stopped_s = 0.0
    speeds = tool_speeds(run)
    for track in run.visitors.values():
        is_near = track.distance < CROSSING
        for first, beyond in _stretches(is_near):
            least.append(float(track.distance[first:beyond].min()))
        step = float(np.median(np.diff(track.times))) if len(track.times) > 1 else 0.0
        tool = np.interp(track.times, run.tool.times, speeds)
        near_s += step * float(is_near.sum())
        stopped_s += step * float((is_near & (tool < STANDS)).sum())
    touches = sum(any(name in run.visitors for name in touch.bodies) for touch in run.touches)
    return VisitorMeasures(
        len(least), tuple(least), near_s, stopped_s, sum(distance < KEPT for distance in least), touches
    )


def visitors_text(found: VisitorMeasures | None) -> str:
    """The measures in a line of a table."""
    if found is None:
        return "-"
    nearest = f"{min(found.least_m):.2f} m" if found.least_m else "-"
    return f"{found.crossings} crossings, {nearest}; {found.touches} contacts"


def _stretches(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First index, and index beyond the last, of every run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(edges[k]), int(edges[k + 1])) for k in range(0, len(edges), 2)]
