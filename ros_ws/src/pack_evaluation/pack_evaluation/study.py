"""Comparison of many runs of one cell: what every cell gives to it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from pack_core.errors import ConfigError
from pack_evaluation.table import TextTable

RECORDINGS = "recordings"
"""Name of the study that holds all recordings of a cell."""


@dataclass(frozen=True)
class KeptTrials:
    """The trials of a benchmark as its folder keeps them.

    Attributes:
        folder: the benchmark's folder.
        settings: settings that decide the results.
        origin: command, commit and versions that the results come from.
        trials: one mapping for each trial, with at least a `name`.
    """

    folder: Path
    settings: Mapping[str, Any]
    origin: Mapping[str, Any]
    trials: Sequence[Mapping[str, Any]]

    def require(self, keys: Iterable[str]) -> None:
        """Refuse trials of another version, which lack keys.

        Raises:
            ConfigError: a trial lacks one of the keys.
        """
        wanted = set(keys)
        for trial in self.trials:
            if missing := sorted(wanted - trial.keys()):
                commit = self.origin.get("commit", "unknown")
                raise ConfigError(
                    f"{self.folder}: trial {trial['name']} lacks {', '.join(missing)}; "
                    f"another version kept it (commit {commit}): measure anew with --fresh"
                )


TrialT = TypeVar("TrialT")


@dataclass(frozen=True, kw_only=True)
class Study(Generic[TrialT]):
    """Runs that belong together: a column or a row of every table.

    Attributes:
        name: what tables call it.
        detail: what tells it from another study of the same name.
        about: settings that the summary and the report show.
        origin: command, commit and versions that the runs come from.
        trials: the runs, measured.
    """

    name: str
    detail: str = ""
    about: Mapping[str, Any] = field(default_factory=dict)
    origin: Mapping[str, Any] = field(default_factory=dict)
    trials: tuple[TrialT, ...] = ()


@dataclass(frozen=True)
class ShownRun:
    """A run in the report: a picture, a video, or only its name and a text."""

    name: str
    text: str = ""
    image: Path | None = None
    video: Path | None = None


StudyT = TypeVar("StudyT", bound=Study[Any])
RecordingT = TypeVar("RecordingT")


@dataclass(frozen=True, kw_only=True)
class StudyEvaluator(Generic[StudyT, RecordingT]):
    """How many runs of one cell become tables, figures and pictures.

    Attributes:
        title: heads the cell's part of a report.
        of_benchmark: the studies that a benchmark's trials make, of different names; raises PackError where a
            file that belongs to a trial is missing or broken.
        read_recording: measures one recording as part of a study; raises PackError where it is missing,
            broken, or of another cell.
        of_recordings: the study that recordings make together, named `RECORDINGS`.
        summary: the statistics of a study as plain values.
        tables: studies side by side.
        figures: writes figures as PNG into a folder, made for them, and returns them in the report's order.
        shown_runs: single runs that a report shows, with files below a folder: of each study, how many are
            drawn, 0 without OpenGL, and how many are rendered as MP4; raises PackError without OpenGL.
        runs_title: heads the single runs.
        runs_note: one sentence on what their pictures show.
        kind_of: name of the cell's part that measures a recording: these studies, or others of the same cell.
    """

    title: str
    of_benchmark: Callable[[KeptTrials], list[StudyT]]
    read_recording: Callable[[Path], RecordingT]
    of_recordings: Callable[[Sequence[RecordingT]], StudyT]
    summary: Callable[[StudyT], dict[str, Any]]
    tables: Callable[[Sequence[StudyT]], Sequence[TextTable]]
    figures: Callable[[Sequence[StudyT], Path], list[Path]] = lambda studies, folder: []
    shown_runs: Callable[[Sequence[StudyT], Path, int, int], list[ShownRun]] = lambda *_: []
    runs_title: str = "Pictures"
    runs_note: str = ""
    kind_of: Callable[[Path], str] = lambda path: "studies"


def summaries(evaluator: StudyEvaluator[StudyT, Any], studies: Sequence[StudyT]) -> dict[str, Any]:
    """The summaries of studies by name."""
    return {study.name: evaluator.summary(study) for study in studies}
