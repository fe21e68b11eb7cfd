"""Commands of `pack` that only the palletizing cell has."""

from __future__ import annotations

from pack_bringup.palletizing import calibrate_command, layout_command, order_command, states_command

APPS = (calibrate_command.app, layout_command.app, order_command.app, states_command.app)
