"""Presets: named differences from a cell's configuration files, `config/presets/<cell>/<name>.yaml`.

A preset lies over the files that its sections name: `cell` over config/cells/<cell>.yaml, a node's name over
that node's parameters in config/nodes/<cell>/. It may lie over another preset of the same cell, its base.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self, TypeVar

import yaml
from pydantic import Field, PrivateAttr

from pack_core.config import Config, merged, parse_config
from pack_core.errors import ConfigError
from pack_core.paths import config_path
from pack_core.text.explanation import Layer
from pack_core.text.reader import read_text

P = TypeVar("P", bound="Preset")
Section = dict[str, Any]
OPTIONS = "options over the preset"
"""Names in errors what a command's options put over a preset."""


class Preset(Config):
    """Differences from the configuration files, by the keys of these files; a cell adds its nodes' sections.

    Attributes:
        base: the preset that this one changes; empty: none.
        cell: overrides config/cells/<cell>.yaml.
    """

    base: str = ""
    cell: Section = Field(default_factory=dict)
    _texts: tuple[tuple[str, str], ...] = PrivateAttr(default=())
    """What the values come from, the uppermost first: name and text of files, and of `OPTIONS`."""

    @classmethod
    def sections(cls) -> tuple[str, ...]:
        """Names of the sections: `cell`, then the nodes."""
        return tuple(name for name in cls.model_fields if name != "base")

    def over(self, section: str, values: Mapping[str, Any]) -> Self:
        """A copy of the preset in which `values` override one of its sections."""
        preset = self.model_copy(update={section: merged(getattr(self, section), values)})
        preset._texts = ((OPTIONS, yaml.safe_dump({section: dict(values)})), *self._texts)
        return preset

    def layers(self, section: str) -> tuple[Layer, ...]:
        """The files that a section's values come from, the uppermost first."""
        return tuple(Layer(name, text, section, name != OPTIONS) for name, text in self._texts)

    def place(self, section: str, key: str) -> str:
        """Where a key of a section stands, for errors."""
        places = (layer.place([key]) for layer in self.layers(section))
        return next((place for place in places if place), "preset")


def read_preset(cls: type[P], cell: str, name: str, above: tuple[str, ...] = ()) -> P:
    """The preset `config/presets/<cell>/<name>.yaml`, over the one that it names as its base.

    Args:
        cls: the cell's class of presets.
        cell: one of the register's cells.
        name: of the file.
        above: presets that lie over this one, the uppermost first.

    Raises:
        ConfigError: there is none, it has a section that is not allowed, or it is its own base.
    """
    if name in above:
        raise ConfigError(f"presets are based on each other in a ring: {' on '.join((*above, name))}")
    path = config_path("presets", cell, f"{name}.yaml")
    if not path.is_file():
        known = ", ".join(sorted(item.stem for item in path.parent.glob("*.yaml")))
        wanted = f", the base of '{above[-1]}'" if above else ""
        raise ConfigError(f"no preset '{name}'{wanted}; allowed: {known} (files in {path.parent})")
    text = read_text(path)
    preset = parse_config(cls, text, str(path), path.parent)
    preset._texts = ((str(path), text),)
    if not preset.base:
        return preset
    base = read_preset(cls, cell, preset.base, (*above, name))
    both = preset.model_copy(update={s: merged(getattr(base, s), getattr(preset, s)) for s in cls.sections()})
    both._texts = (*preset._texts, *base._texts)
    return both
