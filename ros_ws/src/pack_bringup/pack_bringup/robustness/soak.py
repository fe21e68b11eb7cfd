"""What a cell takes of the machine while it runs for hours, read from /proc, and what of it grew."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

PROC = Path("/proc")
SHARED_MEMORY = Path("/dev/shm")
PAGE = os.sysconf("SC_PAGE_SIZE")
WARM_UP = 600.0
"""Time before which growth is not judged [s of wall clock]: caches fill, libraries load."""
HOUR = 3600.0
"""In seconds."""
QUANTITIES = {"memory_mb": "memory [MB]", "threads": "threads", "descriptors": "descriptors"}
Samples = Sequence[Mapping[str, Any]]
"""One mapping a goal: `time` and `duration` [s of wall clock], `seed`, `success`, `message`, `segments`,
the number of shared memory segments on the machine, and `nodes` with the usage of each."""


@dataclass(frozen=True)
class Usage:
    """What one process takes.

    Attributes:
        memory_mb: resident memory [MB].
        threads: number of threads.
        descriptors: number of open files and sockets.
    """

    memory_mb: float
    threads: int
    descriptors: int


def usage_of(pid: int) -> Usage:
    """What a process takes now.

    Raises:
        OSError: there is no such process.
    """
    folder = PROC / str(pid)
    resident = int((folder / "statm").read_text().split()[1])  # the second number: resident pages (proc(5))
    threads, descriptors = (len(list((folder / part).iterdir())) for part in ("task", "fd"))
    return Usage(resident * PAGE / 1e6, threads, descriptors)


def usages(pids: Mapping[str, int]) -> dict[str, Usage]:
    """What each process takes, by name; those that have ended are left out."""
    found = {}
    for name, pid in pids.items():
        try:
            found[name] = usage_of(pid)
        except OSError:
            continue
    return found


def shared_segments(folder: Path = SHARED_MEMORY) -> int:
    """Number of shared memory segments on this machine: a process that was killed leaves its own behind."""
    return len(list(folder.iterdir()))


def growth_per_hour(times: Sequence[float], values: Sequence[float], warm_up: float = WARM_UP) -> float:
    """Growth of a quantity in an hour as a share of its value after the warm-up, by a straight line.

    Args:
        times: of the samples [s].
        values: one for each.
        warm_up: samples before it do not count [s].

    Returns:
        `nan` where fewer than two samples came after the warm-up, or all at one time.
    """
    t, y = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    late = t >= warm_up
    if np.count_nonzero(late) < 2 or np.ptp(t[late]) == 0.0:
        return float("nan")
    slope, at_warm_up = np.polyfit(t[late] - warm_up, y[late], 1)
    return float(slope * HOUR / at_warm_up)


def growth_table(samples: Samples) -> list[tuple[str, ...]]:
    """For each quantity of the nodes and the machine: first, after the warm-up, last, growth an hour [%]."""
    rows: list[tuple[str, ...]] = []
    for node in samples[-1]["nodes"]:
        kept = [sample for sample in samples if node in sample["nodes"]]
        times = [sample["time"] for sample in kept]
        for key, title in QUANTITIES.items():
            rows.append(_growth_row(node, title, times, [sample["nodes"][node][key] for sample in kept]))
    times, segments = ([sample[key] for sample in samples] for key in ("time", "segments"))
    rows.append(_growth_row("machine", "shared memory segments", times, segments))
    return rows


def _growth_row(whose: str, title: str, times: Sequence[float], values: Sequence[float]) -> tuple[str, ...]:
    warm = next((v for t, v in zip(times, values, strict=True) if t >= WARM_UP), float("nan"))
    growth = 100.0 * growth_per_hour(times, values)
    return whose, title, f"{values[0]:.4g}", f"{warm:.4g}", f"{values[-1]:.4g}", f"{growth:+.2f}"


GROWTH_COLUMNS = ("node", "what", "first", "after 10 min", "last", "growth an hour [%]")


def summary(samples: Samples) -> dict[str, Any]:
    """How many goals succeeded, how long they took, and what grew, as plain values."""
    lost = [sample for sample in samples if not sample["success"]]
    durations = [sample["duration"] for sample in samples]
    return {
        "goals": len(samples),
        "succeeded": len(samples) - len(lost),
        "not_succeeded": [{"seed": sample["seed"], "message": sample["message"]} for sample in lost],
        "hours": samples[-1]["time"] / HOUR,
        "duration_mean_s": float(np.mean(durations)),
        "duration_p95_s": float(np.percentile(durations, 95)),
        "growth": [dict(zip(GROWTH_COLUMNS, row, strict=True)) for row in growth_table(samples)],
    }


def plot(samples: Samples, path: Path) -> None:
    """Draw memory, threads and descriptors of each node and the goals' durations over the hours."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(len(QUANTITIES) + 1, 1, sharex=True, figsize=(9, 10), layout="constrained")
    hours = [sample["time"] / HOUR for sample in samples]
    for axis, (key, title) in zip(axes, QUANTITIES.items(), strict=False):
        for node in samples[-1]["nodes"]:
            axis.plot(hours, [s["nodes"].get(node, {}).get(key, np.nan) for s in samples], label=node)
        axis.set_ylabel(title)
    axes[0].legend(ncols=6, fontsize="small")
    for success, mark in ((True, "."), (False, "x")):
        some = [(s["time"] / HOUR, s["duration"]) for s in samples if s["success"] is success]
        axes[-1].plot(
            *zip(*some, strict=True), mark, label="success" if success else "failure"
        ) if some else None
    axes[-1].legend(fontsize="small")
    axes[-1].set_ylabel("goal took [s]")
    axes[-1].set_xlabel("wall clock [h]")
    figure.savefig(path, dpi=120)
    plt.close(figure)
