"""Presets of the palletizing cell: `config/presets/palletizing/<name>.yaml`."""

from __future__ import annotations

from pydantic import Field

from pack_core.presets import Preset, Section, read_preset


class PalletizingPreset(Preset):
    """Differences from the configuration files of the palletizing cell.

    Attributes:
        sim: overrides config/nodes/palletizing/sim.yaml; the other nodes likewise.
    """

    sim: Section = Field(default_factory=dict)
    vision: Section = Field(default_factory=dict)
    layout: Section = Field(default_factory=dict)
    motion: Section = Field(default_factory=dict)
    fsm: Section = Field(default_factory=dict)


def palletizing_preset(name: str) -> PalletizingPreset:
    """The preset called `name`; raises ConfigError."""
    return read_preset(PalletizingPreset, "palletizing", name)
