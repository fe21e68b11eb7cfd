"""The error of a move that cannot be made."""

from __future__ import annotations

from pack_core.errors import PackError


class MoveRefused(PackError):
    """A move must not start; the text names the part of the move and the reason."""
