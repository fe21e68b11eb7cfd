"""Many scenes of the packing cell: run, kept in a folder, and read back as a study."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from pack_evaluation.packing.run import Run
from pack_evaluation.packing.run_file import SUFFIX, load_saved_run, save_run
from pack_evaluation.packing.study.trial import Study, Trial, trial_of
from pack_lockstep.benchmarking.pools import Pool
from pack_lockstep.benchmarking.trial_file import TrialFile, read_trials
from pack_lockstep.packing.settings import SceneJob, Setup
from pack_lockstep.packing.trial import SceneResult, run_scene, trial_line

TRIALS, RUNS, SCENES = "trials.jsonl", "runs", "scenes"
ABOUT = ("method", "optimizer", "weights", "preset", "container", "scene_dir")
"""Settings that reports show."""


class BenchmarkFolder:
    """The results of one benchmark: trials.jsonl, a run and a scene file a trial, and the report."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def exists(self) -> bool:
        """Whether there are results."""
        return (self.path / TRIALS).is_file()

    def count(self, names: Sequence[str]) -> int:
        """How many of these trials there are already."""
        return len(set(names) & read_trials(self.path / TRIALS)[1].keys()) if self.exists else 0

    def clear(self) -> None:
        """Remove the results, and nothing else that is in the folder."""
        (self.path / TRIALS).unlink(missing_ok=True)
        for file in (*self.path.glob(f"{RUNS}/*{SUFFIX}"), *self.path.glob(f"{SCENES}/*.yaml")):
            file.unlink()

    def load(self, name: str) -> Run:
        """A trial's run; raises BagError where it is missing or broken."""
        return load_saved_run(self.path / RUNS / f"{name}{SUFFIX}")

    def keep(self, result: SceneResult) -> Trial:
        """Write a trial's run and scene."""
        for folder in (RUNS, SCENES):
            (self.path / folder).mkdir(parents=True, exist_ok=True)
        (self.path / SCENES / f"{result.job.name}.yaml").write_text(result.scene.to_yaml())
        save_run(result.run, self.path / RUNS / f"{result.job.name}{SUFFIX}")
        return trial_of(result.job.name, result.run)

    def study(self, names: Sequence[str] | None = None) -> Study:
        """The trials, all or those named, measured from their runs.

        Raises:
            PackError: these are no results, or a run is missing.
        """
        settings, trials = read_trials(self.path / TRIALS)
        chosen = list(trials) if names is None else [name for name in names if name in trials]
        about = {key: settings[key] for key in ABOUT if settings.get(key) is not None}
        return Study(settings["name"], tuple(trial_of(name, self.load(name)) for name in chosen), about)


def measure_scenes(
    folder: BenchmarkFolder, setup: Setup, jobs: Sequence[SceneJob], pool: Pool
) -> Iterator[Trial]:
    """Run the scenes that the folder does not have yet, and keep each when it is done.

    Raises:
        PackError: the folder is of other settings, or a scene cannot be run.
    """
    file = TrialFile(folder.path / TRIALS, setup.record())
    missing = [job for job in jobs if job.name not in file.trials]
    for result in pool.run(partial(run_scene, setup), missing):
        trial = folder.keep(result)
        file.add(trial_line(result, trial, setup.config.session.controller.threads))
        yield trial
