"""Comparison of many runs of one cell: the interface that every cell implements."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

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


@dataclass(frozen=True, kw_only=True)
class Study:
    """Runs that belong together: a column or a row of every table.

    Attributes:
        name: what tables call it.
        detail: what tells it from another study of the same name.
        about: settings that the summary and the report show.
        origin: command, commit and versions that the runs come from.
    """

    name: str
    detail: str = ""
    about: Mapping[str, Any] = field(default_factory=dict)
    origin: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Picture:
    """A run in the report: a picture, a video, or only its name and a text."""

    name: str
    text: str = ""
    image: Path | None = None
    video: Path | None = None


StudyT = TypeVar("StudyT", bound=Study)
RecordingT = TypeVar("RecordingT")


class StudyEvaluator(ABC, Generic[StudyT, RecordingT]):
    """How many runs of one cell become tables, figures and pictures.

    Attributes:
        title: heads the cell's part of a report.
        pictures_title: heads the pictures.
        pictures_note: one sentence on what the pictures show.
    """

    title: ClassVar[str]
    pictures_title: ClassVar[str] = "Pictures"
    pictures_note: ClassVar[str] = ""

    @abstractmethod
    def of_benchmark(self, kept: KeptTrials) -> list[StudyT]:
        """The studies that a benchmark's trials make, of different names.

        Raises:
            PackError: a file that belongs to a trial is missing or broken.
        """

    @abstractmethod
    def read_recording(self, path: Path) -> RecordingT:
        """Measure one recording as part of a study.

        Raises:
            PackError: the recording is missing, broken, or of another cell.
        """

    def kind_of(self, path: Path) -> str:
        """Name of the cell's part that measures a recording: these studies, or others of the same cell."""
        return "studies"

    @abstractmethod
    def of_recordings(self, recordings: Sequence[RecordingT]) -> StudyT:
        """The study that recordings make together, named `RECORDINGS`."""

    @abstractmethod
    def summary(self, study: StudyT) -> dict[str, Any]:
        """The statistics of a study as plain values."""

    @abstractmethod
    def tables(self, studies: Sequence[StudyT]) -> Sequence[TextTable]:
        """The studies side by side."""

    def figures(self, studies: Sequence[StudyT], folder: Path) -> list[Path]:
        """Write figures as PNG into a folder, made for them, in the order in which a report shows them."""
        return []

    def pictures(self, studies: Sequence[StudyT], folder: Path, *, count: int, videos: int) -> list[Picture]:
        """Single runs that a report shows.

        Args:
            studies: the runs.
            folder: folder of the report; pictures go into a folder below it.
            count: runs of each study that are drawn; 0: none, which needs no OpenGL.
            videos: runs of each study that are rendered as MP4.

        Raises:
            PackError: there is no OpenGL to draw with.
        """
        return []


def summaries(evaluator: StudyEvaluator[StudyT, Any], studies: Sequence[StudyT]) -> dict[str, Any]:
    """The summaries of studies by name."""
    return {study.name: evaluator.summary(study) for study in studies}
