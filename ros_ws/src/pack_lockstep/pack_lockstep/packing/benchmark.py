"""The benchmark of the packing cell: many scenes, each saved as a run and a scene file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from pack_evaluation.packing.run_file import SUFFIX, save_run
from pack_evaluation.packing.studies import RUNS
from pack_evaluation.packing.study.trial import trial_of
from pack_lockstep.benchmarking.benchmark import Verdict
from pack_lockstep.packing.controlled_benchmark import ControlledBenchmark
from pack_lockstep.packing.settings import PackingSetup, SceneJob
from pack_lockstep.packing.trial import SceneResult, run_scene, trial_line

SCENES = "scenes"


@dataclass(frozen=True)
class PackingBenchmark(ControlledBenchmark[SceneJob, SceneResult]):
    """Runs many scenes under one setting."""

    files: ClassVar[tuple[str, ...]] = (f"{RUNS}/*{SUFFIX}", f"{SCENES}/*.yaml")

    setup: PackingSetup
    jobs: tuple[SceneJob, ...]

    def settings(self) -> Mapping[str, Any]:
        """Everything that decides the results: settings, cell, parameters of all nodes, and weights."""
        return self.setup.record()

    @property
    def work(self) -> Callable[[SceneJob], SceneResult]:
        """The function that runs a scene to its outcome."""
        return partial(run_scene, self.setup)

    def keep(self, result: SceneResult, folder: Path) -> Mapping[str, Any]:
        """Write the run as arrays and the scene as a file to run again, and return the measures."""
        for kind in (RUNS, SCENES):
            (folder / kind).mkdir(parents=True, exist_ok=True)
        (folder / SCENES / f"{result.job.name}.yaml").write_text(result.scene.to_yaml())
        save_run(result.run, folder / RUNS / f"{result.job.name}{SUFFIX}")
        return trial_line(result, trial_of(result.job.name, result.run), self.threads)

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """One line on a trial: how the goal ended, its duration, final distance, forces and placements."""
        text = (
            f"{trial['exit_reason']:12} {trial['execution_time_s']:5.1f} s {trial['distance_cm']:5.1f} cm "
            f"{trial['force_mean_N']:5.1f} N, peak {trial['peak_force_N']:5.0f} N "
            f"{trial['placements']:2.0f} placements"
        )
        return Verdict(trial["name"], trial["success"], text)
