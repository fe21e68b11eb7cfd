"""The job that fills a container: the packing cell's nodes started, and a list packed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pack_bringup.packing.fill_goal import PackingFillGoal, wanted_list
from pack_bringup.packing.job import PackingJob
from pack_lockstep.packing.presets import PackingPreset, load_preset

START = "start.yaml"
"""Scene file, in the run's folder, with which the simulator begins: an empty container."""


@dataclass(frozen=True)
class PackingFillJob(PackingFillGoal, PackingJob):
    """What to run: the goal of a list, with the nodes that a job starts."""


def packing_fill_job(
    seed: int, given: Path | None, *, folder: Path, preset: str, real_time_factor: float | None, command: str
) -> PackingFillJob:
    """The job for a list file or, without one, for objects drawn from the catalogue.

    Raises:
        ConfigError: the list cannot be used, or there is no such preset.
    """
    cell = (load_preset(preset) if preset else PackingPreset()).packing_cell()
    listed = wanted_list(seed, given, cell)
    folder.mkdir(parents=True, exist_ok=True)
    start = folder / START
    start.write_text(listed.start(cell).to_yaml())
    return PackingFillJob(
        seed, start, folder=folder, preset=preset, list_text=listed.to_yaml(),
        real_time_factor=real_time_factor, command=command,
    )  # fmt: skip
