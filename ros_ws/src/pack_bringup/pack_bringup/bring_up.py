"""Waits until the nodes of a cell that were started as processes are ready, or one of them has failed."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from pack_bringup.graph.node_log import last_words
from pack_bringup.graph.processes import ProcessGroup
from pack_core.errors import PackError

if TYPE_CHECKING:
    from pack_bringup.ros.status_listener import StatusListener

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
