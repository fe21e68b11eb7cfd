"""How long each state of the machine takes, and how fast the tool is in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_evaluation.palletizing.run import PalletRun

SLOW = ("3", "4", "7", "8", "9", "10", "11", "12", "13", "17", "18", "19")
"""Numbers of the states with the slow speed (Table 8.1)."""
NEAR_CONTACT = ("3", "4", "8", "9", "12", "13", "17", "18", "19")
"""Those of them in which the arm is within 0.1 m of where the gripper acts; 7, 10 and 11 lead from one
such stretch to the next, through free space over table B."""
SLOW_SPEED = 0.25
"""Of the tool, at most, near contact [m/s]."""


@dataclass(frozen=True)
class StateTime:
    """One state over a run.

    Attributes:
        visits: how often it was entered.
        total_s: time spent in it [s].
        peak_mps: highest measured speed of the tool in it [m/s].
    """

    visits: int
    total_s: float
    peak_mps: float


def state_times(run: PalletRun) -> dict[str, StateTime]:
    """The states that were entered, by label, in the order of their numbers; words come last."""
    times, speeds = run.tool.times, tool_speeds(run)
    found: dict[str, list[tuple[float, float]]] = {}
    last = float(times[-1]) if len(times) else 0.0
    ends = [visit.time for visit in run.visits[1:]] + [last]
    for visit, end in zip(run.visits, ends, strict=True):
        first, beyond = np.searchsorted(times, (visit.time, end))
        peak = float(speeds[first:beyond].max(initial=0.0))
        found.setdefault(visit.state, []).append((end - visit.time, peak))
    return {
        label: StateTime(
            len(found[label]), sum(time for time, _ in found[label]), max(peak for _, peak in found[label])
        )
        for label in sorted(found, key=_rank)
    }


def tool_speeds(run: PalletRun) -> Array:
    """Measured speed of the tool at every moment `(n,)` [m/s]."""
    times, p = run.tool.times, run.tool.p
    if len(times) < 2:
        return np.zeros(len(times))
    return np.asarray(np.linalg.norm(np.gradient(p, times, axis=0), axis=1))


def near_contact_peak(states: Mapping[str, StateTime]) -> float:
    """Highest speed of the tool in the states near contact [m/s]."""
    return max((s.peak_mps for label, s in states.items() if number_of(label) in NEAR_CONTACT), default=0.0)


def number_of(label: str) -> str:
    """The number in a state's label, such as 17 of `17 pre deposit`; its first word where there is none."""
    return label.split(" ")[0]


def merged(runs: Sequence[Mapping[str, StateTime]]) -> dict[str, StateTime]:
    """The states of several runs together."""
    labels = sorted({label for states in runs for label in states}, key=_rank)
    rows = {label: [states[label] for states in runs if label in states] for label in labels}
    return {
        label: StateTime(
            sum(row.visits for row in some),
            sum(row.total_s for row in some),
            max(row.peak_mps for row in some),
        )
        for label, some in rows.items()
    }


def _rank(label: str) -> tuple[int, str]:
    number = number_of(label)
    return (int(number), "") if number.isdigit() else (10_000, label)
