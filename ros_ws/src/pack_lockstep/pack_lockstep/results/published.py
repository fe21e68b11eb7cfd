"""A published result: the summary of a benchmark, with all that tells whether it still holds."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from pack_core.errors import ConfigError
from pack_core.text.json_text import parse_json
from pack_lockstep.benchmarking.sources import digests, fingerprint

PACKAGES = ("mujoco", "numpy", "scipy", "numba", "ruckig", "opencv-python-headless", "shapely")
"""Installed packages without which, in the same version, the figures are not the same."""


def differing_package(before: Mapping[str, str], now: Mapping[str, str]) -> str:
    """What of `PACKAGES` was there in another version, in words; empty where nothing is known to differ."""
    for name in PACKAGES:
        if name in before and before[name] != now.get(name):
            return f"{name} {before[name]} was installed, now {now.get(name)}"
    return ""


class ResultState(Enum):
    """Whether a result is one of this code."""

    VALID = "valid"
    STALE = "stale"
    MISSING = "missing"


@dataclass(frozen=True)
class Standing:
    """The state of a result, and why it is that."""

    state: ResultState
    reason: str = ""


@dataclass(frozen=True)
class PublishedResult:
    """What results/<cell>/<name>.json holds.

    Attributes:
        command: the command that was run.
        date: day on which it ended, as YYYY-MM-DD.
        version, commit: of PackCell.
        machine: processor, cores and memory.
        packages: versions of installed packages.
        summary: the figures, as `--json` gives them.
        sources: files of the project that the run used, with their digests; empty where they were not kept.
    """

    command: str
    date: str
    version: str
    commit: str
    machine: str
    packages: Mapping[str, str]
    summary: Mapping[str, Any]
    sources: Mapping[str, str]

    def save(self, path: Path) -> None:
        """Write the result as JSON."""
        values = {
            "command": self.command, "date": self.date, "version": self.version, "commit": self.commit,
            "machine": self.machine, "packages": dict(self.packages),
            "fingerprint": fingerprint(self.sources) if self.sources else "",
            "summary": self.summary, "sources": dict(self.sources),
        }  # fmt: skip
        path.parent.mkdir(parents=True, exist_ok=True)
        written = path.with_suffix(".part")
        written.write_text(json.dumps(values, indent=1) + "\n")
        written.replace(path)

    def standing(
        self, command: str, packages: Mapping[str, str],
        digests_of: Callable[[Iterable[str]], Mapping[str, str]] = digests,
    ) -> Standing:  # fmt: skip
        """Whether the result is one of the code that is here.

        Args:
            command: what the definition says now.
            packages: what is installed now.
            digests_of: digests of files as they are now.
        """
        if self.command != command:
            return Standing(ResultState.STALE, f"the command was: {self.command}")
        if not self.sources:
            return Standing(ResultState.STALE, f"version {self.version} kept no fingerprint")
        now = digests_of(self.sources)
        changed = [path for path, digest in self.sources.items() if now[path] != digest]
        if changed:
            more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
            return Standing(ResultState.STALE, f"{changed[0]}{more} changed")
        if reason := differing_package(self.packages, packages):
            return Standing(ResultState.STALE, reason)
        return Standing(ResultState.VALID)


def load_result(path: Path) -> PublishedResult | None:
    """The result of a file, None if there is no file.

    Raises:
        ConfigError: it is no file of a result.
    """
    if not path.is_file():
        return None
    values = parse_json(path.read_text(), str(path))
    try:
        return PublishedResult(
            **{name: values[name] for name in PublishedResult.__dataclass_fields__}
        )  # fmt: skip
    except (KeyError, TypeError) as error:
        raise ConfigError(f"{path} is no published result: it lacks {error}; `pack results run`") from error


def file_of(name: str, folder: Path) -> Path:
    """The file of a result in the folder of results."""
    return folder / f"{name}.json"
