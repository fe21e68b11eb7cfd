"""Many packing runs side by side, in the tables and figures of the paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from pack_evaluation.packing.fill.recording import has_fill_job
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.run_file import SUFFIX, load_saved_run
from pack_evaluation.packing.study.summary import FAILURE_METRICS, summarize
from pack_evaluation.packing.study.tables import METRIC_NAMES, tables
from pack_evaluation.packing.study.trial import PackingStudy, PackingTrial, trial_of
from pack_evaluation.packing.video import add_caption, write_video
from pack_evaluation.packing.view import View, ViewConfig
from pack_evaluation.study import RECORDINGS, KeptTrials, Picture, StudyEvaluator
from pack_evaluation.table import TextTable

RUNS = "runs"
"""Folder, below a benchmark's, with the run of each trial."""
ABOUT = ("method", "optimizer", "weights", "preset", "container", "scene_dir")
"""Settings that the summary and the report show."""
SIZE = {"width": 640, "height": 360}
FIG_5 = ("m_pos_mm", "m_rot_deg", "m_per")
MAROON = "#800000"
DPI = 130


class PackingStudies(StudyEvaluator[PackingStudy, PackingTrial]):
    """Measures every trial from its run, whether lockstep or a recording kept it."""

    title: ClassVar[str] = "Packing"
    pictures_title: ClassVar[str] = "Failures"
    pictures_note: ClassVar[str] = (
        "The last moment of each failed run; the translucent shape is the packing pose."
    )

    def of_benchmark(self, kept: KeptTrials) -> list[PackingStudy]:
        """One study: the trials of a method under one setting."""

        def load(name: str) -> Run:
            return load_saved_run(kept.folder / RUNS / f"{name}{SUFFIX}")

        names = [str(trial["name"]) for trial in kept.trials]
        about = {key: kept.settings[key] for key in ABOUT if kept.settings.get(key) is not None}
        trials = tuple(trial_of(name, load(name)) for name in names)
        return [
            PackingStudy(
                name=kept.settings["name"], about=about, origin=kept.origin, trials=trials, load=load
            )
        ]

    def read_recording(self, path: Path) -> PackingTrial:
        """The last goal of a recording, named by the recording's path."""
        return trial_of(str(path), load_run(path))

    def kind_of(self, path: Path) -> str:
        """A recording that holds a fill job is none of a single goal."""
        return "fill_studies" if has_fill_job(path) else "studies"

    def of_recordings(self, recordings: Sequence[PackingTrial]) -> PackingStudy:
        """All recordings as trials."""
        return PackingStudy(name=RECORDINGS, trials=tuple(recordings), load=lambda name: load_run(Path(name)))

    def summary(self, study: PackingStudy) -> dict[str, Any]:
        """Counts, the spread of every measure, and the failures by name."""
        return summarize(study)

    def tables(self, studies: Sequence[PackingStudy]) -> Sequence[TextTable]:
        """The paper's Tables II and III, contact forces, iterations and failure metrics."""
        return tables(studies)

    def figures(self, studies: Sequence[PackingStudy], folder: Path) -> list[Path]:
        """Share of packed scenes over time, and the box plots of Fig. 5."""
        return write_figures(studies, folder)

    def pictures(
        self, studies: Sequence[PackingStudy], folder: Path, *, count: int, videos: int
    ) -> list[Picture]:
        """Every failed run."""
        return [
            picture
            for i, study in enumerate(studies, 1)
            for picture in failure_pictures(study, folder / "failures" / str(i), count=count, videos=videos)
        ]


STUDIES = PackingStudies()


def failure_pictures(study: PackingStudy, folder: Path, *, count: int, videos: int) -> list[Picture]:
    """Every failed run of a study: the last moment of the first `count`, and `videos` of them whole.

    Args:
        study: the runs.
        folder: for the files; made if it is missing and something is drawn.
        count: how many are drawn.
        videos: how many are rendered as MP4.

    Raises:
        PackError: there is no OpenGL to draw with, or a run cannot be read.
    """
    shown = []
    for i, trial in enumerate(study.failures):
        m = trial.measures
        picture = Picture(trial.name, f"{m.exit_reason.value}, {trial.message}; {m.placements} placements")
        if i < count and study.load is not None:
            picture = _drawn(picture, study.load(trial.name), folder, with_video=i < videos)
        shown.append(picture)
    return shown


def _drawn(picture: Picture, run: Run, folder: Path, *, with_video: bool) -> Picture:
    folder.mkdir(parents=True, exist_ok=True)
    stem = picture.name.strip("/").replace("/", "_")  # a recording is named by its path
    image, video = folder / f"{stem}.png", folder / f"{stem}.mp4" if with_video else None
    _write_last(run, image)
    if video:
        write_video(run, video)
    return replace(picture, image=image, video=video)


def _write_last(run: Run, path: Path) -> None:
    with View(run, ViewConfig().model_copy(update=SIZE)) as view:
        Image.fromarray(add_caption(view.picture(run.end), run, run.end)).save(path)


def write_figures(studies: Sequence[PackingStudy], folder: Path) -> list[Path]:
    """Write every figure as PNG into `folder`, in the order a report shows them."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [_write_packed_by(studies, folder / "packed_by.png")]
    for i, study in enumerate(studies):
        paths.append(_write_boxes(study, folder / f"failure_metrics_{i + 1}.png"))
    return paths


def _write_boxes(study: PackingStudy, path: Path) -> Path:
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    figure.suptitle(study.name)
    for axes, name in zip(figure.subplots(1, len(FIG_5)), FIG_5, strict=True):
        _draw_boxes(axes, name, study)
    figure.savefig(path, dpi=DPI)
    return path


def _draw_boxes(axes: Axes, name: str, study: PackingStudy) -> None:
    """One metric as in Fig. 5: quartiles, whiskers to 1.5 of their range, median maroon, mean a triangle."""
    groups = {
        f"success ({len(study.successes)})": _values(name, study.successes),
        f"failure ({len(study.failures)})": _values(name, study.failures),
    }
    axes.boxplot(
        list(groups.values()), tick_labels=list(groups), whis=1.5, showmeans=True, widths=0.5,
        medianprops={"color": MAROON, "linewidth": 1.6},
        meanprops={"marker": "^", "markerfacecolor": "blue", "markeredgecolor": "blue"},
    )  # fmt: skip
    axes.set_title(METRIC_NAMES[name], fontsize=10)
    axes.set_ylim(bottom=0.0)
    axes.grid(axis="y", alpha=0.25)


def _values(name: str, trials: Sequence[PackingTrial]) -> list[float]:
    values = [FAILURE_METRICS[name](trial.measures) for trial in trials]
    return [value for value in values if not np.isnan(value)]


def _write_packed_by(studies: Sequence[PackingStudy], path: Path) -> Path:
    """Share of the scenes that are packed and done, by simulated time."""
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    axes = figure.add_subplot()
    end = max((t.measures.execution_time for s in studies for t in s.trials), default=1.0)
    for study in studies:
        times = np.sort([trial.measures.execution_time for trial in study.successes])
        share = 100.0 * np.arange(times.size + 1) / max(1, len(study.trials))
        axes.step([0.0, *times, end], [*share, share[-1]], where="post", label=study.name)
    axes.set(xlabel="time since the goal [s]", ylabel="scenes packed [%]", ylim=(0, 102), xlim=(0, end))
    axes.grid(alpha=0.25)
    axes.legend(loc="lower right", frameon=False)
    figure.savefig(path, dpi=DPI)
    return path
