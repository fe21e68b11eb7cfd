"""The folder of a benchmark's results, the same for every cell."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pack_core.errors import ConfigError
from pack_evaluation.study import KeptTrials
from pack_lockstep.benchmarking.trial_file import TrialFile, read_trials

TRIALS, SUMMARY = "trials.jsonl", "summary.json"


class ResultsFolder:
    """trials.jsonl, summary.json, report.html, and whatever files a cell keeps beside its trials.

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
        """Remove the results and nothing else: the trials, and files by their patterns."""
        (self.path / TRIALS).unlink(missing_ok=True)
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
    def commit(self) -> str:
        """The commit that the results were begun with; empty where there are none, or it was not kept."""
        if not self.is_at(self.path):
            return ""
        return str(read_trials(self.path / TRIALS).origin.get("commit", ""))

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
