"""A preset for the node graph: parameters of its nodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml

from pack_lockstep.packing.lockstep_config import lockstep_config
from pack_lockstep.packing.presets import load_preset

NODES = ("sim", "perception", "planner", "mpc")
RECORDER = "recorder"
"""Notes the preset's name in run.yaml."""


def preset_overrides(name: str) -> dict[str, dict[str, str]]:
    """What a preset changes, by node and parameter, as YAML text.

    Raises:
        ConfigError: there is no such preset, or it changes what is not there.
    """
    preset = load_preset(name)
    preset.packing_cell()
    lockstep_config(preset)
    facts = {"cell": _text(_text(preset.cell))} if preset.cell else {}
    nodes = {node: {**facts, **_parameters(getattr(preset, node))} for node in NODES}
    return {**nodes, RECORDER: {"preset": _text(name)}}


def _parameters(section: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """Nested keys as dotted names."""
    found: dict[str, str] = {}
    for key, value in section.items():
        name = prefix + key
        found |= _parameters(value, f"{name}.") if isinstance(value, Mapping) else {name: _text(value)}
    return found


def _text(value: Any) -> str:
    """YAML in one line."""
    text: str = yaml.safe_dump(value, default_flow_style=True, default_style=None, width=float("inf"))
    return text.removesuffix("...\n").strip()
