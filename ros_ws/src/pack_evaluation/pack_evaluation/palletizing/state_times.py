"""How long each state of the machine takes, and how fast the tool is in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pack_core.rotations import Array
from pack_evaluation.palletizing.run import PalletRun, StateVisit

NEAR_CONTACT = ("3", "4", "8", "9", "12", "13", "17", "18", "19")
"""Numbers of the states in which the arm is within 0.1 m of where the gripper acts; 7, 10 and 11, which
Table 8.1 has slow, too, lead from one such place to the next, through free space over table B."""


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
    for visit, end in _visits(run):
        first, beyond = np.searchsorted(times, (visit.time, end))
        peak = float(speeds[first:beyond].max(initial=0.0))
        found.setdefault(visit.state, []).append((end - visit.time, peak))
    return {
        label: StateTime(
            len(found[label]), sum(time for time, _ in found[label]), max(peak for _, peak in found[label])
        )
        for label in sorted(found, key=_rank)
    }


def slow_states(run: PalletRun) -> set[str]:
    """Labels of the states that moves ran slowly for most of their time."""
    slow: dict[str, float] = {}
    for visit, left in _visits(run):
        within = (
            min(end, left) - max(start, visit.time)
            for start, end in run.slow
            if start < left and end > visit.time
        )
        slow[visit.state] = slow.get(visit.state, 0.0) + sum(within)
    times = state_times(run)
    return {label for label, time in slow.items() if time > 0.5 * times[label].total_s}


def _visits(run: PalletRun) -> Iterator[tuple[StateVisit, float]]:
    """The visits of states, each with the time at which the state was left [s]."""
    last = float(run.tool.times[-1]) if len(run.tool.times) else 0.0
    return zip(run.visits, [*(visit.time for visit in run.visits[1:]), last], strict=True)


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
