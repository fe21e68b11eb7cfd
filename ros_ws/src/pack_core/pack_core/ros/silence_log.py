"""What a node writes to its log about peers that are silent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pack_core.ros.peer_watch import PeerWatch

LASTING = 3.0
"""Silence that is written to the log [s of wall clock]. It is acted upon and reported at once; but a busy
machine keeps nodes waiting while a cell starts, and nodes end one after the other when it ends."""


class SilenceLog:
    """Writes a line for each silence that lasts; an error only where no process of the peer is left.

    Args:
        logger: of the node that watches.
    """

    def __init__(self, logger: Any) -> None:
        self._logger = logger
        self._since: dict[str, float] = {}

    def note(self, peer: str, now: float) -> None:
        """A peer has fallen silent at `now` [s]; any thread may say so."""
        self._since[peer] = now

    def write(self, watches: Sequence[PeerWatch], now: float) -> None:
        """Write about the silences that have lasted until `now` [s]; to be called now and then."""
        for peer, since in list(self._since.items()):
            watch = next(watch for watch in watches if watch.peer == peer)
            if watch.is_alive:
                self._since.pop(peer, None)
            elif now - since > LASTING:
                self._since.pop(peer, None)
                self._write(watch)

    def _write(self, watch: PeerWatch) -> None:
        if watch.has_ended:
            self._logger.error(f"node '{watch.peer}' has ended: restart it (pack run, or pack up)")
        else:
            self._logger.warning(
                f"node '{watch.peer}' lives but is silent: it hangs, or this machine is too busy"
            )
