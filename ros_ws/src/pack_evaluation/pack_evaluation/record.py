"""Reads run.yaml, which records the settings and origin of a run, from the run's folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pack_core.cells import CELLS
from pack_core.config import load_values
from pack_core.errors import BagError, ConfigError

RECORD = "run.yaml"


def load_record(recording: Path) -> dict[str, Any]:
    """The content of run.yaml in a run's folder or beside its bag; empty if there is none.

    Raises:
        BagError: the file is broken.
    """
    for folder in (recording, recording.parent):
        if (folder / RECORD).is_file():
            return _read(folder / RECORD)
    return {}


def about_the_run(record: Mapping[str, Any]) -> dict[str, str]:
    """What a report says of how a run was made, in words: run.yaml without its configuration files."""
    return {name: _in_words(value) for name, value in record.items() if name != "configuration"}


def _in_words(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {part}" for name, part in value.items())
    return "none" if value is None or value == "" else str(value)


def _read(path: Path) -> dict[str, Any]:
    try:
        return load_values(path)
    except ConfigError as error:
        raise BagError(
            f"{path} is broken: it should be YAML, a key a line; was it cut off?\n{error}"
        ) from error


def cell_of(recording: Path) -> str:
    """The cell that was recorded; raises BagError if run.yaml names an unknown one.

    A bag without run.yaml and a run that a benchmark saved are assumed to be of the first cell.
    """
    cell = str(load_record(recording).get("cell", CELLS[0]))
    if cell not in CELLS:
        raise BagError(f"{recording}: run.yaml names the cell '{cell}'; known: {', '.join(CELLS)}")
    return cell
