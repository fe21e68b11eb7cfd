"""What grows in a run of hours: growth is told after the warm-up, and every process is read."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from multiprocessing.shared_memory import SharedMemory
from pathlib import Path
from typing import Any

import pytest

from pack_bringup.robustness.soak import (
    SHARED_MEMORY,
    WARM_UP,
    growth_per_hour,
    growth_table,
    plot,
    shared_segments,
    summary,
    usage_of,
    usages,
)


def samples(growth: float) -> list[dict[str, Any]]:
    """A goal a minute for 70 minutes; the memory of `mpc` leaps at first and then grows [MB an hour]."""
    return [
        {
            "time": 60.0 * k, "seed": k, "success": k != 7, "message": "" if k != 7 else "time-out",
            "duration": 50.0, "segments": 3,
            "nodes": {
                "mpc": {
                    "memory_mb": 100.0 if 60.0 * k < WARM_UP else 200.0 + growth * (k - 10) / 60.0,
                    "threads": 20, "descriptors": 30,
                }
            },
        }
        for k in range(70)
    ]  # fmt: skip


def test_growth_is_told_after_the_warm_up_as_a_share_of_what_was_there_then() -> None:
    kept = samples(4.0)
    rows = {row[1]: row for row in growth_table(kept)}
    assert rows["memory [MB]"] == ("mpc", "memory [MB]", "100", "200", "203.9", "+2.00")
    assert abs(float(rows["threads"][-1])) < 0.1
    assert rows["shared memory segments"][:-1] == ("machine", "shared memory segments", "3", "3", "3")


def test_too_short_a_run_tells_no_growth() -> None:
    assert math.isnan(growth_per_hour([0.0, 100.0], [1.0, 2.0]))
    assert math.isnan(growth_per_hour([700.0, 700.0], [1.0, 2.0]))


def test_a_goal_that_was_lost_is_named(tmp_path: Path) -> None:
    found = summary(samples(0.0))
    assert (found["goals"], found["succeeded"]) == (70, 69)
    assert found["not_succeeded"] == [{"seed": 7, "message": "time-out"}]
    plot(samples(0.0), tmp_path / "soak.png")
    assert (tmp_path / "soak.png").stat().st_size > 10_000


GROWING = """
import os, sys, threading
print("begun", flush=True)
sys.stdin.readline()
held, ended = bytearray(b"x") * 50_000_000, threading.Event()
thread = threading.Thread(target=ended.wait)
thread.start()
with open(os.devnull):
    print("grown", flush=True)
    sys.stdin.readline()
ended.set()
"""
"""A process that takes 50 MB, a thread and a descriptor on request; in ours other tests free some, too."""


def test_memory_threads_and_descriptors_of_a_process_are_read() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", GROWING], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        found = []
        for _ in range(2):
            child.stdout.readline()
            found.append(usage_of(child.pid))
            child.stdin.write("\n")
            child.stdin.flush()
    before, after = found
    assert after.memory_mb - before.memory_mb == pytest.approx(50.0, abs=10.0)
    assert after.threads == before.threads + 1
    assert after.descriptors == before.descriptors + 1


def test_shared_memory_segments_are_counted(tmp_path: Path) -> None:
    assert shared_segments(tmp_path) == 0
    (tmp_path / "fastrtps_left_behind").touch()
    assert shared_segments(tmp_path) == 1
    segment = SharedMemory(create=True, size=1000)
    try:
        assert (SHARED_MEMORY / segment.name).exists()
    finally:
        segment.close()
        segment.unlink()


def test_a_process_that_has_ended_is_left_out() -> None:
    child = subprocess.Popen(["true"])
    child.wait()
    assert list(usages({"we": os.getpid(), "dead": child.pid})) == ["we"]
