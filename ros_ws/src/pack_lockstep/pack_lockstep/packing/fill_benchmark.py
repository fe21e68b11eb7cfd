"""The benchmark of filled containers: many lists, each packed from its first object to its last."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import FillMethod
from pack_core.packing.packing_list import PackingList, supermarket_list
from pack_lockstep.benchmarking.benchmark import Verdict
from pack_lockstep.packing.controlled_benchmark import ControlledBenchmark
from pack_lockstep.packing.fill_lockstep import FillLockstep
from pack_lockstep.packing.fill_result import FillResult
from pack_lockstep.packing.lockstep_config import LockstepConfig, lockstep_config
from pack_lockstep.packing.presets import PackingPreset, load_preset

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
        return {
            "name": self.setup.name, "studies": self.studies, "method": self.setup.method.value,
            "preset": self.setup.preset, "cell": self.setup.cell.model_dump(mode="json"), "config": config,
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
        ConfigError: there is no such preset.
    """
    given: PackingPreset = load_preset(preset)
    given = given.over("mpc", {"controller": {"threads": threads}}).over("planner", {"threads": threads})
    return FillSetup(method, preset, given.packing_cell(), lockstep_config(given))


def list_jobs(seed: int, count: int, cell: PackingCell) -> tuple[ListJob, ...]:
    """Lists of supermarket objects, the first drawn with `seed`, each with the next."""
    return tuple(ListJob(f"seed_{n}", n, supermarket_list(n, cell)) for n in range(seed, seed + count))
