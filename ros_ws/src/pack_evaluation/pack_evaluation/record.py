"""What a run was made with: run.yaml in its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from pack_core.cells import CELLS
from pack_core.errors import BagError

RECORD = "run.yaml"


def load_record(recording: Path) -> dict[str, Any]:
    """What run.yaml holds in the run's folder or, of a bag, beside it; empty where there is none.

    Raises:
        BagError: the file is broken.
    """
    for folder in (recording, recording.parent):
        if (folder / RECORD).is_file():
            return _read(folder / RECORD)
    return {}


def _read(path: Path) -> dict[str, Any]:
    try:
        found = yaml.safe_load(path.read_text())
    except yaml.YAMLError:
        found = None
    if not isinstance(found, dict):
        raise BagError(f"{path} is broken: it should be YAML, a key a line; was it cut off?")
    return found


def cell_of(recording: Path) -> str:
    """The cell that was recorded; raises BagError where run.yaml names one that there is not.

    A bag without run.yaml, and a run that a benchmark saved, are taken for the first cell's.
    """
    cell = str(load_record(recording).get("cell", CELLS[0]))
    if cell not in CELLS:
        raise BagError(f"{recording}: run.yaml names the cell '{cell}'; known: {', '.join(CELLS)}")
    return cell
