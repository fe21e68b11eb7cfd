"""Waits until the nodes of a cell are ready, and says from their log why one has ended."""

from __future__ import annotations

import io
import re
import signal
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from pack_bringup.graph.processes import ProcessGroup
from pack_core.errors import PackError

if TYPE_CHECKING:
    from pack_bringup.ros.status_listener import StatusListener

COLOUR = re.compile(r"\x1b\[[0-9;]*m")
LAST_LINES = 12
"""Lines of a node's log that an error shows: they hold the end of a traceback, and fit on a screen."""
ERROR = "error: "
"""How the line begins in which a node says why it ends (pack_core/ros/run.py)."""
CRASH, CRASHED_THREAD = "Fatal Python error: ", "Current thread "
"""How the lines begin in which Python says that C or C++ code broke, and in which of the threads."""


class Tee(io.TextIOBase):
    """Writes to a terminal and, without colours, to a file."""

    def __init__(self, terminal: TextIO, file: TextIO) -> None:
        self._terminal, self._file = terminal, file

    def isatty(self) -> bool:
        """Whether colours are wanted."""
        return self._terminal.isatty()

    def write(self, text: str) -> int:
        """Write to both; one that takes nothing, a full disk or a closed pipe, does not silence the other."""
        with suppress(OSError):
            self._file.write(COLOUR.sub("", text))
        with suppress(OSError):
            self._terminal.write(text)
        return len(text)

    def flush(self) -> None:
        """Have both written, as far as they take it."""
        for stream in (self._file, self._terminal):
            with suppress(OSError):
                stream.flush()


def lines_of(log: Path, name: str) -> list[str]:
    """What a node has written, without time and name."""
    parts = [line.partition("|") for line in log.read_text(errors="replace").splitlines()]
    return [text.strip() for head, _, text in parts if f" {name} " in head]


def last_words(log: Path, name: str) -> str:
    """Why a node ended: the error that it named, else where it crashed, else the last lines that it wrote."""
    lines = lines_of(log, name)
    if errors := [line.removeprefix(ERROR) for line in lines if line.startswith(ERROR)]:
        return f"{errors[-1]} (log: {log})"
    if crash := _crash(lines):
        return f"it crashed in the code of a library; all its threads are in {log}:\n  " + "\n  ".join(crash)
    shown = "\n  ".join(lines[-LAST_LINES:]) or "it wrote nothing"
    return f"its last lines in {log}:\n  {shown}"


def _crash(lines: list[str]) -> list[str]:
    """What was said of the last crash, then what the thread that crashed was doing; empty for none."""
    crashes = [i for i, line in enumerate(lines) if line.startswith(CRASH)]
    if not crashes:
        return []
    at = crashes[-1]
    thread = next((i for i in range(at, len(lines)) if lines[i].startswith(CRASHED_THREAD)), at)
    return lines[max(at - 1, 0) : at + 1] + lines[thread + 1 : thread + 1 + LAST_LINES]


REMIND_PERIOD = 10.0
"""Wall clock after which it is said what is still waited for [s]."""


def check_alive(group: ProcessGroup, log: Path) -> None:
    """Raise a PackError that says which node has ended, and why, if one has."""
    for name, code in group.exit_codes.items():
        raise PackError(f"node '{name}' ended with exit code {code}: {last_words(log, name)}")


def wait_until_ready(
    group: ProcessGroup, listener: StatusListener, names: list[str], log: Path, say: Callable[[str], None]
) -> None:
    """Return when every node has said that it is ready.

    Args:
        group: the processes.
        listener: hears what the nodes say.
        names: of the nodes.
        log: file with what they write.
        say: is told what is waited for when it takes long.

    Raises:
        PackError: a node has ended; the text names it, its reason and the log.
    """

    def is_settled() -> bool:
        return bool(group.exit_codes) or not listener.unready(names)

    try:
        while not listener.spin_until(is_settled, REMIND_PERIOD):
            waiting = [f"{name} ({why})" for name, why in listener.unready(names).items()]
            say(f"waiting for {', '.join(waiting)}")
        check_alive(group, log)
    except BaseException:
        # A node that is still being loaded would answer Ctrl-C with a traceback; this ends it without one.
        for name in group.running:
            group.signal(name, signal.SIGTERM)
        raise
