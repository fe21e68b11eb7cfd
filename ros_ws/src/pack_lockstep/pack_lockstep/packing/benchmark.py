"""The benchmarks of the packing cell: many scenes, or many lists of objects to fill containers with."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Protocol

from pack_core.errors import ConfigError, PackError
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.goals import FillMethod
from pack_core.packing.packing_list import PackingList, supermarket_list
from pack_core.packing.scene import Scene
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.run_file import SUFFIX, save_run
from pack_evaluation.packing.seen_objects import figures
from pack_evaluation.packing.studies import RUNS
from pack_evaluation.packing.summary import FAILURE_METRICS, PackingTrial, trial_of
from pack_lockstep.benchmarking.benchmark import Benchmark, JobT, ResultT, Verdict
from pack_lockstep.packing.fill_lockstep import FillLockstep, FillResult
from pack_lockstep.packing.lockstep import Lockstep
from pack_lockstep.packing.lockstep_config import LockstepConfig, PackingPreset, load_preset, lockstep_config
from pack_lockstep.packing.settings import PackingSetup, SceneJob
from pack_sim.packing.scene_generator import generate_scene


class ControlledSetup(Protocol):
    """Settings with everything that they refer to."""

    @property
    def name(self) -> str:
        """Short name for tables: method and conditions."""

    @property
    def config(self) -> LockstepConfig:
        """Parameters of all nodes."""


class ControlledBenchmark(Benchmark[JobT, ResultT]):
    """A benchmark of the packing cell.

    Attributes:
        setup: the same for all trials.
    """

    cell: ClassVar[str] = "packing"
    setup: ControlledSetup

    @property
    def threads(self) -> int:
        """Number of threads that the controller of each trial plans with."""
        return self.setup.config.session.controller.threads

    @property
    def folder_name(self) -> str:
        """The setup's name: method and conditions."""
        return self.setup.name.replace(" ", "_")


@dataclass(frozen=True)
class SceneResult:
    """A scene, its run, and the wall clock time that the run took [s]."""

    job: SceneJob
    scene: Scene
    run: Run
    wall_time: float


def run_scene(setup: PackingSetup, job: SceneJob) -> SceneResult:
    """Run one scene to its outcome; the run depends on nothing but the arguments.

    Raises:
        PackError: the scene cannot be generated.
    """
    started = time.perf_counter()
    try:
        scene = job.scene or generate_scene(job.seed, setup.cell, blocked=setup.settings.blocked)
    except PackError as error:
        raise PackError(f"{job.name}: {error}") from error
    lockstep = Lockstep(setup.cell, scene, setup.config, setup.settings.method, job.seed)
    lockstep.run()
    run, wall_time = lockstep.recorded(), time.perf_counter() - started
    return SceneResult(job, scene, run, wall_time)


def trial_line(result: SceneResult, trial: PackingTrial, threads: int) -> dict[str, Any]:
    """The trial's line in the file of results; times in [s], forces in [N], shares in [%]."""
    m = trial.measures
    return {
        "name": result.job.name, "seed": result.job.seed, "success": m.success,
        "exit_reason": m.exit_reason.value, "message": trial.message, "execution_time_s": m.execution_time,
        "distance_cm": 1e2 * m.distance, "contained": m.is_contained, "protrusion_mm": 1e3 * m.protrusion,
        "tilt_deg": math.degrees(m.tilt), "chatter_percent": 1e2 * m.chatter,
        "force_mean_N": m.force_mean, "force_p95_N": m.force_p95,
        "iterations": m.iterations, "iteration_ms": m.iteration_ms, "displacement_cm": 1e2 * m.displacement,
        **{name: metric(m) for name, metric in FAILURE_METRICS.items()},
        "threads": threads, "wall_time_s": result.wall_time,
        **({} if trial.perception is None else {"perception": figures([trial.perception])}),
    }  # fmt: skip


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
        """One line on a trial: how the goal ended and how long it took, distance, forces, placements."""
        text = (
            f"{trial['exit_reason']:12} {trial['execution_time_s']:5.1f} s {trial['distance_cm']:5.1f} cm "
            f"{trial['force_mean_N']:5.1f} N, peak {trial['peak_force_N']:5.0f} N "
            f"{trial['placements']:2.0f} placements"
        )
        if (perception := trial.get("perception")) is not None:
            text += f", found {perception['found']} of {perception['objects']}"
        return Verdict(trial["name"], trial["success"], text)


LISTS = "lists"


@dataclass(frozen=True)
class ListJob:
    """A list to pack; the seed is that of the noise as well."""

    name: str
    seed: int
    given: PackingList


@dataclass(frozen=True)
class FillSetup:
    """Settings of a benchmark with everything that they refer to."""

    method: FillMethod
    preset: str
    cell: PackingCell
    config: LockstepConfig

    @property
    def name(self) -> str:
        """Short name for tables: method and conditions."""
        return f"fill {self.method.value} {self.preset}"


@dataclass(frozen=True)
class PackingFillBenchmark(ControlledBenchmark[ListJob, tuple[ListJob, FillResult, float]]):
    """Fills many containers under one setting."""

    studies: ClassVar[str] = "fill_studies"
    files: ClassVar[tuple[str, ...]] = (f"{LISTS}/*.yaml",)

    setup: FillSetup
    jobs: tuple[ListJob, ...]

    def settings(self) -> Mapping[str, Any]:
        """Everything that decides the results; threads do not."""
        config = self.setup.config.model_dump(mode="json")
        config["session"]["controller"].pop("threads")
        config["planner"].pop("threads")
        config["estimator"].pop("depth")
        cell = self.setup.cell.model_dump(mode="json", exclude={"depth", "perception"})
        return {
            "name": self.setup.name, "studies": self.studies, "method": self.setup.method.value,
            "preset": self.setup.preset, "cell": cell, "config": config,
        }  # fmt: skip

    @property
    def work(self) -> Callable[[ListJob], tuple[ListJob, FillResult, float]]:
        """The function that packs a list to its end."""
        return partial(run_list, self.setup)

    def keep(self, result: tuple[ListJob, FillResult, float], folder: Path) -> Mapping[str, Any]:
        """Write the list as a file to run again, and return the measures."""
        job, found, wall_time = result
        (folder / LISTS).mkdir(parents=True, exist_ok=True)
        (folder / LISTS / f"{job.name}.yaml").write_text(job.given.to_yaml())
        return {
            "name": job.name, "seed": job.seed, **found.measures(),
            "rows": [row.row() for row in found.report.objects], "threads": self.threads,
            "wall_time_s": wall_time,
        }  # fmt: skip

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """One line on a list: objects, area, time and force."""
        durations = trial["durations"]
        mean = sum(durations) / len(durations) if durations else float("nan")
        text = (
            f"{trial['objects']}/{trial['given']} objects, {1e2 * trial['base_area']:3.0f} % of the base, "
            f"{mean:4.1f} s an object, {trial['force']:3.0f} N"
            + "".join(f", {fault}" for fault in trial["faults"])
        )
        return Verdict(trial["name"], trial["without_fault"], text)


def run_list(setup: FillSetup, job: ListJob) -> tuple[ListJob, FillResult, float]:
    """Pack one list to its end; the result depends on nothing but the arguments."""
    started = time.perf_counter()
    lockstep = FillLockstep(setup.cell, job.given, setup.config, setup.method, job.seed)
    lockstep.run()
    return job, lockstep.result(), time.perf_counter() - started


def fill_setup(method: FillMethod, preset: str, threads: int) -> FillSetup:
    """Read what the settings refer to.

    Raises:
        ConfigError: there is no such preset, or it is for perception by depth.
    """
    given: PackingPreset = load_preset(preset)
    if given.packing_cell().perception is Perception.DEPTH:
        raise ConfigError(f"preset '{preset}' with --fill; allowed: presets with motion capture")
    given = given.over("mpc", {"controller": {"threads": threads}}).over("planner", {"threads": threads})
    return FillSetup(method, preset, given.packing_cell(), lockstep_config(given))


def list_jobs(seed: int, count: int, cell: PackingCell) -> tuple[ListJob, ...]:
    """Lists of supermarket objects, the first drawn with `seed`, each with the next."""
    return tuple(ListJob(f"seed_{n}", n, supermarket_list(n, cell)) for n in range(seed, seed + count))
