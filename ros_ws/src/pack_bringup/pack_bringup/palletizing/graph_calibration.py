"""A calibration file for the node graph: parameters of the nodes that know the cell."""

from __future__ import annotations

import json
from pathlib import Path

from pack_bringup.palletizing.graph_preset import NODES
from pack_core.palletizing.calibration import known_cell


def calibration_overrides(preset: str, file: Path) -> dict[str, dict[str, str]]:
    """What a calibration changes, by node and parameter, as YAML text.

    Args:
        preset: what the cell is like; empty: the ideal one.
        file: what `pack calibrate palletizing` has written.

    Raises:
        ConfigError: the file cannot be read, or was made under another preset.
    """
    known_cell(preset or "rigid", str(file))
    return {node: {"calibration": json.dumps(str(file.resolve()))} for node in NODES}
