"""Why a move cannot be made."""

from __future__ import annotations

from pack_core.errors import PackError


class MoveRefused(PackError):
    """A move that must not start; its text names the part of it, and what stands against it."""
