"""Evaluation of a recording, the same for every cell: measures, plots, video and report."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import yaml

from pack_evaluation.goals import GoalNumber, RecordedRun
from pack_evaluation.html import render
from pack_evaluation.record import about_the_run, load_record
from pack_evaluation.table import Row, measure_rows

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

VIDEO, REPLAY, REPORT, PLOTS = "run.mp4", "replay.html", "report.html", "plots"
OnProgress = Callable[[float], None]
"""Called with the fraction that is done, 0 to 1."""
WriteReplay = Callable[[Path, Path], None]
"""Writes a recording, given first, as an interactive replay into the HTML file that is given second."""

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


@dataclass(frozen=True)
class Evaluator(Generic[RunT, MeasuresT]):
    """How the recordings of one cell are evaluated: what the cell alone knows of it.

    Attributes:
        load: the goal of a number, from 1, in a recording, or the last; raises BagError where the recording
            is missing, broken, of another version, or has no such goal.
        measure: everything that is measured of a run.
        draw: writes the plots into a folder that exists, and returns them in the order of the report.
        film: renders a run as MP4, and calls with the fraction that is done.
        template: the report, below this package; it extends report.html.j2.
        report: values of the template: `title`, whether it was a `success`, the `verdict` in a few words, a
            `message`, and what the cell's own blocks of the template show.
        speed: simulated seconds a second of the video.
        still: writes one large picture, where a cell has one beside its plots.
        instead: the evaluator that a recording is for where it is not for this one.
    """

    load: Callable[[Path, int | None], RunT]
    measure: Callable[[RunT], MeasuresT]
    draw: Callable[[RunT, Path], list[Path]]
    film: Callable[[RunT, Path, OnProgress], None]
    template: str
    report: Callable[[Evaluation[RunT, MeasuresT]], Mapping[str, Any]]
    speed: float = 1.0
    still: Callable[[RunT, Path], None] = lambda run, path: None
    instead: Callable[[Path], Evaluator[Any, Any] | None] = lambda path: None

    def evaluate(
        self, path: Path, output: Path, *, with_video: bool = True, progress: OnProgress = lambda _: None,
        write_replay: WriteReplay | None = None, goal: int | None = None,
    ) -> Evaluation[Any, Any]:  # fmt: skip
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
        if goal is None and (other := self.instead(path)):
            return other.evaluate(path, output, with_video=with_video, progress=progress)
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
        found.report.write_text(self._page(found))
        return found

    def _film_whole(self, run: RunT, path: Path, progress: OnProgress) -> None:
        """Render the run; a file of this name is there only once it is whole."""
        part = path.with_stem(f"{path.stem}.part")
        try:
            self.film(run, part, progress)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)

    def _page(self, found: Evaluation[RunT, MeasuresT]) -> str:
        """The report as HTML; the cell's own values come last and may replace any."""
        configuration = found.record.get("configuration", {})
        values = {
            "run": found.run, "measures": found.measures, "rows": found.rows, "plots": found.plots,
            "video": found.video, "speed": self.speed, "replay": found.replay,
            "about": about_the_run(found.record),
            "files": {name: yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
                      for name, content in configuration.items()},
        }  # fmt: skip
        return render(self.template, **{**values, **self.report(found)})


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
