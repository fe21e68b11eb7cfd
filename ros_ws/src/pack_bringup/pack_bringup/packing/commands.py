"""Commands of `pack` that only the packing cell has."""

from __future__ import annotations

from pack_bringup.packing import replay_command

APPS = (replay_command.app,)
