"""Goals of a running graph in real time, one seed after the other, beside other programs."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from pack_bringup.graph.processes import ProcessGroup
from pack_bringup.pace import LATE_MS, Pace
from pack_core.errors import ConfigError
from pack_evaluation.spread import spread

BUSY = (sys.executable, "-c", "while True: pass")
"""A program that takes all that one processor gives it, at normal priority."""
GOAL_COLUMNS = (
    "goal", "ended", "real-time factor", "iteration, median, 95 % [ms]", f"over {LATE_MS:.0f} ms"
)  # fmt: skip
"""Of the table with a row a goal."""


def seeds_of(text: str) -> range:
    """Seeds from `0..9`, both ends included, or of a single number.

    Raises:
        ConfigError: it is neither.
    """
    first, dots, last = text.partition("..")
    last = last if dots else first
    if not (first.isdecimal() and last.isdecimal()) or int(last) < int(first):
        raise ConfigError(f"--seeds {text}; allowed: a seed, or the first and the last as in 0..9")
    return range(int(first), int(last) + 1)


@contextmanager
def busy_processes(count: int) -> Iterator[None]:
    """So many other programs that would each take a whole processor."""
    if not count:
        yield
        return
    names = [f"busy_{number}" for number in range(1, count + 1)]
    with Path(os.devnull).open("w") as output, ProcessGroup(dict.fromkeys(names, BUSY), output=output):
        yield


def goal_report(seed: int, success: bool, message: str, pace: Pace | None) -> dict[str, Any]:
    """How a goal went, as plain values; without a pace where the nodes did not pursue it to its end."""
    ms = pace.iterations_ms if pace else ()
    return {
        "name": f"seed {seed}", "seed": seed, "success": success, "message": message,
        "wanted_factor": pace.wanted if pace else None,
        "factor": pace.factor if pace else None,
        "iteration_ms": {"median": float(np.median(ms)), "p95": float(np.percentile(ms, 95))} if ms else None,
        "late_percent": 100.0 * pace.late_share if pace and ms else None,
    }  # fmt: skip


def goal_row(report: Mapping[str, Any]) -> tuple[str, ...]:
    """A kept report as a row of `GOAL_COLUMNS`."""
    factor, ms, late = report["factor"], report["iteration_ms"], report["late_percent"]
    return (
        report["name"],
        "success" if report["success"] else report["message"] or "failure",
        "" if factor is None else f"{factor:.3f}",
        "" if ms is None else f"{ms['median']:.0f}, {ms['p95']:.0f}",
        "" if late is None else f"{late:.1f} %",
    )


def summary(reports: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """How many goals succeeded, and how fast time ran meanwhile, as plain values."""
    factors = [report["factor"] for report in reports if report["factor"] is not None]
    wanted = [report["wanted_factor"] for report in reports if report["wanted_factor"] is not None]
    lost = [report for report in reports if not report["success"]]
    return {
        "goals": len(reports),
        "succeeded": len(reports) - len(lost),
        "not_succeeded": [{"seed": report["seed"], "message": report["message"]} for report in lost],
        "wanted_factor": max(wanted, default=None),
        "factor": asdict(spread(factors)),
        "least_factor": min(factors, default=None),
    }
