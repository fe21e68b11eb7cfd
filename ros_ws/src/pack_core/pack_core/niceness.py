"""Has a process's niceness count against the processes of other sessions, too."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

AUTOGROUP = Path("/proc/self/autogroup")


def share_niceness_with_session() -> None:
    """Give our session our niceness, if we began it and Linux shares the processors between sessions.

    It does so by default on desktops (man 7 sched, "The autogroup feature"): each session gets the same
    share, and a niceness counts only within its session. Every node is a session of its own, so without this
    call the niceness in a graph's file would change nothing.
    """
    niceness = os.nice(0)
    if niceness > 0 and os.getsid(0) == os.getpid():
        with suppress(OSError):  # a kernel without the feature, or /proc mounted read-only
            AUTOGROUP.write_text(str(niceness))
