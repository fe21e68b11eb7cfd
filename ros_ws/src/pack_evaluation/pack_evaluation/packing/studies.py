"""Many packing runs side by side, in the tables and figures of the paper."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from pack_evaluation.packing.fill.recording import has_fill_job
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.run_file import SUFFIX, load_saved_run
from pack_evaluation.packing.study.failures import failure_pictures
from pack_evaluation.packing.study.figures import write_figures
from pack_evaluation.packing.study.summary import summarize
from pack_evaluation.packing.study.tables import tables
from pack_evaluation.packing.study.trial import PackingStudy, PackingTrial, trial_of
from pack_evaluation.study import RECORDINGS, KeptTrials, Picture, StudyEvaluator
from pack_evaluation.table import TextTable

RUNS = "runs"
"""Folder, below a benchmark's, with the run of each trial."""
ABOUT = ("method", "optimizer", "weights", "preset", "container", "scene_dir")
"""Settings that the summary and the report show."""


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
