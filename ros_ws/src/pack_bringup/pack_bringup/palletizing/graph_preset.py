"""A preset for the node graph: parameters of its nodes."""

from __future__ import annotations

import json

from pack_core.palletizing.cell import palletizing_cell

NODES = ("sim", "vision", "fsm")
"""The nodes that know the cell: its driver, its eye, and the machine that places boxes."""
RECORDER = "recorder"
"""Notes the preset's name in run.yaml."""


def preset_overrides(name: str) -> dict[str, dict[str, str]]:
    """What a preset of config/cells/palletizing.yaml changes, by node and parameter, as YAML text.

    Raises:
        ConfigError: there is no such preset.
    """
    palletizing_cell(name)
    return {node: {"preset": json.dumps(name)} for node in (*NODES, RECORDER)}
