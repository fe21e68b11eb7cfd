"""Registers: what there is of one kind by name, from the package that ships and from others.

A package lists in its own code what ships with it. Any other package adds to that list by an entry point in
its setup.py, and the first neither imports nor names it:

    entry_points={"pack_mpc.optimizers": ["judo = pack_baselines.judo_optimizer:JudoOptimizer"]}

An object is imported when it is asked for, so that whoever only lists the names, as `--help` does, loads
nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

from pydantic import create_model

from pack_core.config import Config
from pack_core.errors import ConfigError

T = TypeVar("T")
C = TypeVar("C", bound=Config)


class Register(Mapping[str, T]):
    """Objects of one kind by their names: those that ship, the default first, then the others by name.

    Args:
        kind: what one of them is called in errors, e.g. `optimizer`.
        group: group of the entry points that add to it, e.g. `pack_mpc.optimizers`.
        shipped: `module:attribute` of those that ship, by name.
    """

    def __init__(self, kind: str, group: str, shipped: Mapping[str, str]) -> None:
        self._kind, self._group, self._shipped = kind, group, shipped

    @cached_property
    def _entries(self) -> dict[str, EntryPoint]:
        entries = {name: EntryPoint(name, value, self._group) for name, value in self._shipped.items()}
        for added in sorted(entry_points(group=self._group), key=lambda entry: entry.name):
            if added.name in entries:
                both = f"{entries[added.name].value} and {added.value}"
                raise ConfigError(f"two of group {self._group} are called '{added.name}': {both}")
            entries[added.name] = added
        return entries

    def __getitem__(self, name: str) -> T:
        """The object called `name`, imported now; raises ConfigError where there is none."""
        found: T = self._entries[self.checked(name)].load()
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def checked(self, name: str) -> str:
        """The name, of which nothing is imported yet; raises ConfigError where there is none."""
        if name not in self._entries:
            allowed = f"{', '.join(self)}; others register in the group {self._group} of entry points"
            raise ConfigError(f"{self._kind} '{name}'; allowed: {allowed}")
        return name

    def known(self, name: str) -> str:
        """The name, to validate a field of a configuration; anything else is refused with those allowed."""
        if name not in self._entries:
            raise ValueError(", ".join(self))
        return name


def with_fields(fields: Mapping[str, Any]) -> Callable[[type[C]], type[C]]:
    """A class decorator: adds fields to a configuration class, each a type and what it defaults to.

    It is for fields that follow from a list kept elsewhere, so that they are not written out a second time.
    """

    def extended(cls: type[C]) -> type[C]:
        return create_model(
            cls.__name__, __base__=cls, __module__=cls.__module__, __doc__=cls.__doc__, **fields
        )

    return extended


def with_sections(sections: Mapping[str, type[Config]]) -> Callable[[type[C]], type[C]]:
    """A class decorator: adds to a configuration class one section of parameters for each name.

    So whoever registers something brings its parameters along, and a node has them under its name.
    """
    return with_fields({name: (section, section()) for name, section in sections.items()})
