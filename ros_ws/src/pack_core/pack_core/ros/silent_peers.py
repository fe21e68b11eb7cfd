"""Which watched nodes are silent, and since when."""

from __future__ import annotations


class SilentPeers:
    """The watched nodes that are silent now; true while there is one.

    Written by the threads that watch and read by the executor: each method reads a copy.
    """

    def __init__(self) -> None:
        self._since: dict[str, float] = {}

    def __bool__(self) -> bool:
        return bool(self._since)

    def __str__(self) -> str:
        return ", ".join(sorted(self._since.copy()))

    def note(self, peer: str, is_alive: bool, now: float) -> None:
        """A node has fallen silent, or was heard of again, at `now` [s]."""
        if is_alive:
            self._since.pop(peer, None)
        else:
            self._since.setdefault(peer, now)

    def lasting(self, duration: float, now: float) -> list[str]:
        """Names of the nodes that have been silent for longer than `duration` [s], sorted."""
        return sorted(peer for peer, since in self._since.copy().items() if now - since > duration)
