"""Evaluation of a recording, the same for every cell: measures, plots, video and report."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from pack_evaluation.goals import GoalNumber
from pack_evaluation.record import load_record
from pack_evaluation.table import Row, measure_rows

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

VIDEO, REPLAY, REPORT, PLOTS = "run.mp4", "replay.html", "report.html", "plots"
OnProgress = Callable[[float], None]
"""Called with the fraction that is done, 0 to 1."""
WriteReplay = Callable[[Path, Path], None]
"""Writes a recording, given first, as an interactive replay into the HTML file that is given second."""


class RecordedRun(Protocol):
    """A run as it was read from a recording."""

    @property
    def is_cut(self) -> bool:
        """Whether the recording was cut off."""

    @property
    def damaged(self) -> int:
        """Number of pieces of the recording that could not be read."""

    @property
    def notes(self) -> tuple[str, ...]:
        """Which files and topics of the recording are missing or were left out, and why."""

    @property
    def goal(self) -> GoalNumber:
        """Which goal of the recording it is."""


RunT = TypeVar("RunT", bound=RecordedRun)
MeasuresT = TypeVar("MeasuresT", bound="DataclassInstance")


@dataclass(frozen=True)
class Evaluation(Generic[RunT, MeasuresT]):
    """Results of an evaluation and the files that it wrote; `rows` are the measures in words.

    `plots` are PNG files, `video` and `replay` are None where none was wanted, and `record` is what run.yaml
    holds.
    """

    run: RunT
    measures: MeasuresT
    rows: tuple[Row, ...]
    record: dict[str, Any]
    plots: list[Path]
    video: Path | None
    report: Path
    replay: Path | None = None

    def to_json(self) -> dict[str, Any]:
        """The measures as plain values, NaN as None."""
        which = {"goal": self.run.goal.number, "goals": self.run.goal.count}
        state = {"is_cut": self.run.is_cut, "damaged": self.run.damaged}
        return {**_plain(asdict(self.measures)), **state, **which}


class Evaluator(ABC, Generic[RunT, MeasuresT]):
    """How the recordings of one cell are evaluated."""

    def evaluate(
        self, path: Path, output: Path, *, with_video: bool = True, progress: OnProgress = lambda _: None,
        write_replay: WriteReplay | None = None, goal: int | None = None,
    ) -> Evaluation[RunT, MeasuresT]:  # fmt: skip
        """Measure a recording and write its report.

        Args:
            path: a run's folder, a bag's folder or an MCAP file.
            output: the folder for report.html, plots/ and run.mp4.
            with_video: render the run.
            progress: called with the fraction of the video that is rendered.
            write_replay: writes the interactive replay that the report links; None: there is none.
            goal: which goal of a recording with several, from 1; None: the last.

        Raises:
            BagError: the recording is missing, broken, or holds no such goal of this cell.
            PackError: the video was wanted and there is no OpenGL to draw with.
        """
        run = self.load(path, goal)
        measures = self.measure(run)
        (output / PLOTS).mkdir(parents=True, exist_ok=True)
        video = output / VIDEO if with_video else None
        if video:
            self._film_whole(run, video, progress)
        replay = output / REPLAY if write_replay else None
        if write_replay and replay:
            write_replay(path, replay)
        plots = self.draw(run, output / PLOTS)
        rows, record = (*_goal_rows(run.goal), *measure_rows(measures)), load_record(path)
        found = Evaluation(run, measures, rows, record, plots, video, output / REPORT, replay)
        found.report.write_text(self.page(found))
        return found

    def _film_whole(self, run: RunT, path: Path, progress: OnProgress) -> None:
        """Render the run; a file of this name is there only once it is whole."""
        part = path.with_stem(f"{path.stem}.part")
        try:
            self.film(run, part, progress)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)

    @abstractmethod
    def load(self, path: Path, goal: int | None = None) -> RunT:
        """A goal's run in a recording: the goal of this number, from 1, or the last.

        Raises:
            BagError: the recording is missing, broken, of another version, or has no such goal.
        """

    @abstractmethod
    def measure(self, run: RunT) -> MeasuresT:
        """Everything that is measured of a run."""

    @abstractmethod
    def draw(self, run: RunT, folder: Path) -> list[Path]:
        """Write the plots into a folder that exists, in the order a report shows them."""

    @abstractmethod
    def film(self, run: RunT, path: Path, progress: OnProgress) -> None:
        """Render the run as MP4."""

    @abstractmethod
    def page(self, found: Evaluation[RunT, MeasuresT]) -> str:
        """The report."""

    def still(self, run: RunT, path: Path) -> None:
        """Write one large picture, where a cell has one beside its plots."""


def _goal_rows(goal: GoalNumber) -> tuple[Row, ...]:
    """A row that says which goal was measured, where there are others."""
    meaning = "which goal of the recording this is; `pack evaluate --goal N` measures another"
    return (Row("goal", str(goal), meaning),) if goal.count > 1 else ()


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return None if value != value else value
