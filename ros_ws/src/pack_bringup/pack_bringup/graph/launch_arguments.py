"""What the arguments of the launch file mean for a cell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import get_args

from pack_bringup.recording.record import Record
from pack_core.errors import ConfigError

SCENE_PARAMETERS = {"packing": "sim.scene", "blocks": "sim.problem"}
"""The parameter that takes a file with what stands in the cell, by cell."""
SEEDED = ("packing", "palletizing")
"""Cells whose simulator draws something from a seed."""
YES, NO = "true", "false"


def launch_settings(cell: str, arguments: Mapping[str, str]) -> list[str]:
    """Settings `node.parameter=value` from `seed`, `scene` and `record`; empty ones are left out.

    Raises:
        ConfigError: the cell has no such argument, or not this value.
    """
    settings = []
    if seed := arguments.get("seed", ""):
        if cell not in SEEDED:
            raise ConfigError(
                f"seed:={seed}: cell '{cell}' has no seed; cells that have: {', '.join(SEEDED)}"
            )
        settings.append(f"sim.seed={seed}")
    if scene := arguments.get("scene", ""):
        if cell not in SCENE_PARAMETERS:
            raise ConfigError(
                f"scene:={scene}: cell '{cell}' has no scene file; cells that have: "
                f"{', '.join(SCENE_PARAMETERS)}; the palletizing cell takes order:="
            )
        settings.append(f"{SCENE_PARAMETERS[cell]}={scene}")
    if record := arguments.get("record", ""):
        if record not in get_args(Record):
            raise ConfigError(f"record:={record}; allowed: {', '.join(get_args(Record))}")
        settings.append(f"recorder.record={record}")
    return settings


def order_command(cell: str, order: str) -> list[str]:
    """The command that sends the palletizing cell an order once it is up; empty where none is given.

    Raises:
        ConfigError: another cell was given an order.
    """
    if not order:
        return []
    if cell != "palletizing":
        raise ConfigError(f"order:={order}: only the cell 'palletizing' takes orders, not '{cell}'")
    return ["pack", "goal", "palletizing", "--order", order]


def is_yes(name: str, value: str) -> bool:
    """Whether a switch is on.

    Raises:
        ConfigError: the value is neither true nor false.
    """
    if value not in (YES, NO):
        raise ConfigError(f"{name}:={value}; allowed: {YES}, {NO}")
    return value == YES
