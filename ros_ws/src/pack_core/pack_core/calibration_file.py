"""Which cell a calibration file is of: those of two cells have little in common but their name."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel

from pack_core.config import parse_config, parse_values
from pack_core.errors import ConfigError
from pack_core.text.reader import read_text

C = TypeVar("C", bound=BaseModel)

MARKS = {"packing": "described", "palletizing": "gears"}
"""By cell, a key that its calibrations have and no other cell's."""


def parse_calibration_of(cell: str, cls: type[C], text: str, source: str) -> C:
    """Read the text of a calibration file.

    Args:
        cell: the cell that it has to be of.
        cls: the class of this cell's calibrations.
        text: the text.
        source: names it in errors.

    Raises:
        ConfigError: it is of another cell, or has a key or value that is not allowed.
    """
    values = parse_values(text, source)
    others = [other for other, mark in MARKS.items() if mark in values and MARKS[cell] not in values]
    if others:
        raise ConfigError(
            f"{source}: a calibration of the {others[0]} cell; expected is one of the {cell} cell, as "
            f"`pack calibrate {cell}` writes it: give that to --calibration, or to the nodes' `calibration`"
        )
    return parse_config(cls, text, source)


def load_calibration_of(cell: str, cls: type[C], path: Path) -> C:
    """Read a calibration file of a cell; raises ConfigError as `parse_calibration_of` does."""
    return parse_calibration_of(cell, cls, read_text(path), str(path))
