"""The folder of a benchmark's results, the same for every cell, and its trials, one JSON object a line."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pack_core.cells import CELLS
from pack_core.errors import ConfigError
from pack_core.text.json_text import parse_json
from pack_evaluation.study import KeptTrials
from pack_lockstep.benchmarking.sources import digests

SHOWN = 6
"""Differences that an error names."""


@dataclass(frozen=True)
class TrialLines:
    """What a file of trials holds.

    Attributes:
        cell: the cell that was measured.
        settings: all that decides the results.
        origin: command, commit and versions of the run that began the file.
        trials: one mapping a trial, by its `name`, in the order in which they ended.
    """

    cell: str
    settings: dict[str, Any]
    origin: dict[str, Any]
    trials: dict[str, dict[str, Any]]


class TrialFile:
    """Cell, settings and origin of a benchmark in the first line, a trial in each line after it.

    Args:
        path: the file; made if it is missing.
        cell: the cell that is measured; a file of another one is refused.
        settings: all that decides the results; a file of other settings is refused.
        origin: command, commit and versions, kept in a new file.

    Raises:
        ConfigError: the file is of another cell or of other settings, or no file of trials.
    """

    def __init__(
        self, path: Path, cell: str, settings: Mapping[str, Any], origin: Mapping[str, Any] | None = None
    ) -> None:
        self._path = path
        wanted = json.loads(json.dumps(plain(settings)))
        _cut_off_what_is_not_whole(path)
        if not path.is_file() or not path.stat().st_size:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._write({"cell": cell, "origin": plain(origin or {}), "settings": wanted})
        found = read_trials(path)
        self._trials = found.trials
        if differences := _differences(
            {"benchmark of": found.cell, **found.settings}, {"benchmark of": cell, **wanted}
        ):
            shown = "\n  ".join(differences[:SHOWN])
            more = f"\n  and {len(differences) - SHOWN} more" if len(differences) > SHOWN else ""
            raise ConfigError(
                f"{path} holds trials of other settings:\n  {shown}{more}\n"
                "give another --output, or --fresh to measure anew"
            )

    @property
    def trials(self) -> dict[str, dict[str, Any]]:
        """The trials so far by `name`."""
        return dict(self._trials)

    def add(self, trial: Mapping[str, Any]) -> None:
        """Write one more trial, which has a `name` of its own; it is on the disk on return."""
        values = plain(trial)
        self._write(values)
        self._trials[values["name"]] = values

    def _write(self, values: Mapping[str, Any]) -> None:
        with self._path.open("a") as file:
            file.write(json.dumps(values, allow_nan=False) + "\n")
            file.flush()
            os.fsync(file.fileno())


def _cut_off_what_is_not_whole(path: Path) -> None:
    """Take out of a file, if there is one, a last line at which whoever wrote it was killed."""
    if not path.is_file():
        return
    content = path.read_bytes()
    whole = content.rfind(b"\n") + 1
    if whole != len(content):
        os.truncate(path, whole)


def read_trials(path: Path) -> TrialLines:
    """What a benchmark has kept so far, also while it runs; a last line that is not whole yet is none.

    Raises:
        ConfigError: this is no file of trials.
    """
    try:
        text = path.read_text(encoding="utf-8")
        whole = text[: text.rfind("\n") + 1]
        header, *lines = [parse_json(line, str(path)) for line in whole.splitlines()]
        # Files without a cell are from before other cells than the first had folders of results.
        cell, origin = header.get("cell", CELLS[0]), header.get("origin", {})
        return TrialLines(cell, header["settings"], origin, {line["name"]: line for line in lines})
    except (OSError, ValueError, KeyError, AttributeError, TypeError, ConfigError) as error:
        raise ConfigError(
            f"{path} is no file of trials: {error!r}; delete it or give another --output"
        ) from error


def plain(value: Any) -> Any:
    """A value as strict JSON has it: what is not finite becomes text, tuples become lists."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    before, after = _flat(old), _flat(new)
    return [
        f"{key}: {before.get(key, 'nothing')} in the file, {after.get(key, 'nothing')} now"
        for key in [*after, *(key for key in before if key not in after)]
        if before.get(key, ...) != after.get(key, ...)
    ]


def _flat(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in values.items():
        flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


TRIALS, SUMMARY, SOURCES = "trials.jsonl", "summary.json", "sources.json"


class ResultsFolder:
    """trials.jsonl, sources.json, summary.json, report.html, and what a cell keeps beside its trials.

    Args:
        path: the folder; made when the first trial is kept.

    Raises:
        ConfigError: the path is a file, or its name is that of one.
    """

    def __init__(self, path: Path) -> None:
        if path.is_file() or path.suffix in {".jsonl", ".json", ".html"}:
            raise ConfigError(
                f"--output {path} names a file, but results are a folder with {TRIALS}, {SUMMARY} and "
                f"report.html; give a folder, e.g. --output {path.with_suffix('')}"
            )
        self.path = path

    @classmethod
    def is_at(cls, path: Path) -> bool:
        """Whether there are results at a path."""
        return (path / TRIALS).is_file()

    def open(self, cell: str, settings: Mapping[str, Any], origin: Mapping[str, Any]) -> TrialFile:
        """The file of trials; raises ConfigError if it is of another cell or of other settings."""
        return TrialFile(self.path / TRIALS, cell, settings, origin)

    def count(self, names: Iterable[str]) -> int:
        """How many of these trials there are already."""
        if not self.is_at(self.path):
            return 0
        return len(set(names) & read_trials(self.path / TRIALS).trials.keys())

    def clear(self, files: Iterable[str]) -> None:
        """Remove the results and nothing else: the trials, their sources, and files by their patterns."""
        for name in (TRIALS, SOURCES):
            (self.path / name).unlink(missing_ok=True)
        for file in (found for pattern in files for found in self.path.glob(pattern)):
            file.unlink()

    @property
    def cell(self) -> str:
        """The cell that the results are of."""
        return read_trials(self.path / TRIALS).cell

    @property
    def studies(self) -> str:
        """The cell's part that reports the results."""
        return str(read_trials(self.path / TRIALS).settings.get("studies", "studies"))

    @property
    def sources(self) -> dict[str, str]:
        """Files of the project that the trials depend on, with the digest of each when it was first used."""
        path = self.path / SOURCES
        return dict(parse_json(path.read_text(), str(path))) if path.is_file() else {}

    def add_sources(self, paths: Iterable[str]) -> None:
        """Keep which files of the project were used, and their digests where a file was not used before."""
        before = self.sources
        if new := set(paths) - before.keys():
            written = (self.path / SOURCES).with_suffix(".part")
            written.write_text(json.dumps({**before, **digests(new)}, indent=1, sort_keys=True))
            written.replace(self.path / SOURCES)

    def changed_sources(self) -> list[str]:
        """Files of the project that the trials depend on and that are different now."""
        before = self.sources
        now = digests(before)
        return [path for path in before if before[path] != now[path]]

    def kept(self, names: Sequence[str] | None = None) -> KeptTrials:
        """The trials that are named, in that order, as far as there are; all of them if None.

        Raises:
            ConfigError: there is no file of trials.
        """
        found = read_trials(self.path / TRIALS)
        wanted = list(found.trials) if names is None else [name for name in names if name in found.trials]
        trials = [found.trials[name] for name in wanted]
        origin = {**found.origin, "results": str(self.path)}
        return KeptTrials(self.path, found.settings, origin, trials)
