"""The job that fills a container: the packing cell's nodes started, and a list packed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from pack_bringup.cell_goal import Progress
from pack_bringup.packing.job import PackingJob
from pack_core.packing.packing_list import PackingList, draw_list, load_list
from pack_core.paths import config_path
from pack_lockstep.packing.fill_benchmark import CATALOGUE, OBJECTS
from pack_lockstep.packing.presets import PackingPreset, load_preset

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract

START = "start.yaml"
"""Scene file, in the run's folder, with which the simulator begins: an empty container."""


@dataclass(frozen=True)
class PackingFillJob(PackingJob):
    """What to run.

    Attributes:
        list_text: text of the list.
    """

    list_text: str = ""

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import FillContainer

        from pack_core.ros.contracts.packing import FILL_CONTAINER

        return FILL_CONTAINER, FillContainer.Goal(list=self.list_text, seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.stage} {feedback.object}",
            f"{feedback.stage:9} {feedback.object:14} {feedback.elapsed:5.1f} s  packed {feedback.packed}, "
            f"{feedback.remaining} to come, {100 * feedback.base_area:3.0f} % of the base  real-time factor "
            f"{real_time_factor:4.2f}",
        )


def packing_fill_job(
    seed: int, given: Path | None, *, folder: Path, preset: str, real_time_factor: float | None, command: str
) -> PackingFillJob:
    """The job for a list file or, without one, for objects drawn from the catalogue.

    Raises:
        ConfigError: the list cannot be used, or there is no such preset.
    """
    cell = (load_preset(preset) if preset else PackingPreset()).packing_cell()
    listed = draw_list(seed, OBJECTS, load_list(config_path(*CATALOGUE), cell)) if given is None else None
    listed = listed or load_list(given or Path(), cell)
    folder.mkdir(parents=True, exist_ok=True)
    start = folder / START
    start.write_text(listed.start(cell).to_yaml())
    return PackingFillJob(seed, start, folder=folder, preset=preset, list_text=_text(listed),
        real_time_factor=real_time_factor, command=command,
    )  # fmt: skip


def _text(given: PackingList) -> str:
    return yaml.safe_dump(given.model_dump(mode="json", exclude_none=True), sort_keys=False)
