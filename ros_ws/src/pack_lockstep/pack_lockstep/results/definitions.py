"""results/benchmarks.yaml: which benchmarks the published figures come from."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import Field, field_validator, model_validator

from pack_core.cells import CELLS
from pack_core.config import Config, load_config
from pack_core.errors import ConfigError
from pack_core.paths import project_root


class BenchmarkDefinition(Config):
    """A benchmark whose summary is published."""

    command: str
    """What stands behind `pack benchmark`; paths are relative to the project."""
    before: str = ""
    """What stands behind `pack` in a command that is run first; what it uses counts as well."""
    trend: str
    """Which figures of its summary the history keeps, a name of `trends`."""
    minutes: float = Field(gt=0.0)
    """Time that it takes on one quiet core [min]; those that take long are run first."""
    jobs: int | None = Field(default=None, ge=1)
    """Trials at a time, where it must not be chosen: 1 for what is timed on the wall clock."""

    @property
    def arguments(self) -> list[str]:
        """The words of the command."""
        return shlex.split(self.command)

    @property
    def is_live(self) -> bool:
        """Whether the nodes run, which they do for one goal at a time and on this machine only."""
        return self.arguments[:1] == ["live"]

    @property
    def line(self) -> str:
        """All that is run, as one types it."""
        before = f"pack {self.before}; " if self.before else ""
        return f"{before}pack benchmark {self.command}"


class SeedRange(Config):
    """Seeds from the first to the last, both included."""

    first: int = Field(ge=0)
    last: int = Field(ge=0)


class Definitions(Config):
    """All benchmarks by their name, `<cell>/<name>`."""

    tuning_seeds: dict[str, SeedRange]
    """By cell: seeds on which parameters may be tuned; no published figure comes from them."""
    trends: dict[str, dict[str, str]]
    """By kind of benchmark: where its summary has the figures of the history, as a path with dots."""
    benchmarks: dict[str, BenchmarkDefinition]

    @field_validator("benchmarks")
    @classmethod
    def _names_begin_with_their_cell(
        cls, given: dict[str, BenchmarkDefinition]
    ) -> dict[str, BenchmarkDefinition]:
        for name, definition in given.items():
            cell, _, rest = name.partition("/")
            if cell not in CELLS or not rest.isidentifier():
                raise ValueError(
                    f"{name}; allowed: one of {', '.join(CELLS)}, a slash, and a name of letters"
                )
            if definition.arguments[definition.is_live :][:1] != [cell]:
                raise ValueError(
                    f"{name}: {definition.command}; allowed: a command that begins with {cell} or live {cell}"
                )
        return given

    @model_validator(mode="after")
    def _trends_exist(self) -> Definitions:
        for name, definition in self.benchmarks.items():
            if definition.trend not in self.trends:
                raise ValueError(f"{name}: trend {definition.trend}; allowed: {', '.join(self.trends)}")
        return self

    def chosen(self, names: Iterable[str]) -> dict[str, BenchmarkDefinition]:
        """The benchmarks that are named, or all of them if none is, those that take long first.

        A name may be that of a cell, for all of its benchmarks.

        Raises:
            ConfigError: there is no benchmark of that name.
        """
        wanted = set()
        for name in names:
            found = {key for key in self.benchmarks if key == name or key.startswith(f"{name}/")}
            if not found:
                raise ConfigError(
                    f"no benchmark {name}; allowed: {', '.join((*CELLS, *self.benchmarks))} "
                    f"(results/{DEFINITIONS})"
                )
            wanted |= found
        ordered = sorted(self.benchmarks.items(), key=lambda item: -item[1].minutes)
        return {name: definition for name, definition in ordered if not wanted or name in wanted}

    def trend_of(self, name: str, summary: Mapping[str, Any]) -> dict[str, Any]:
        """The figures of the history, by the name of their column; None where the summary has none."""
        paths = self.trends[self.benchmarks[name].trend]
        return {column: _at(summary, path) for column, path in paths.items()}


DEFINITIONS = "benchmarks.yaml"


def results_path() -> Path:
    """The folder of the published results."""
    return project_root() / "results"


def load_definitions(folder: Path | None = None) -> Definitions:
    """The definitions of a folder, by default of the project's.

    Raises:
        ConfigError: they cannot be read.
    """
    return load_config(Definitions, (folder or results_path()) / DEFINITIONS)


def _at(values: Mapping[str, Any], path: str) -> Any:
    found: Any = values
    for key in path.split("."):
        found = found.get(key) if isinstance(found, Mapping) else None
    return found
