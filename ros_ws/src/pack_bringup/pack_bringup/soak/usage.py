"""What the processes of a cell take of the machine, read from /proc."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

PROC = Path("/proc")
SHARED_MEMORY = Path("/dev/shm")
PAGE = os.sysconf("SC_PAGE_SIZE")


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
