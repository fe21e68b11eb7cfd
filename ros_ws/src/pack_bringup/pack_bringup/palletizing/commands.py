"""Commands of `pack` that only the palletizing cell has."""

from __future__ import annotations

from pack_bringup.palletizing import layout_command, order_command, states_command

APPS = (layout_command.app, order_command.app, states_command.app)
