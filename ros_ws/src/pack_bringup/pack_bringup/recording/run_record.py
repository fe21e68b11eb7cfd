"""What a run was: seed, command, commit, versions and configuration, written beside its bag."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Any, Literal

import yaml

from pack_bringup.graph.graph import load_graph
from pack_core.config import Config
from pack_core.paths import bags_path, config_path
from pack_core.text.reader import load_yaml
from pack_evaluation.provenance import checked_out_commit, installed_versions
from pack_evaluation.record import RECORD

Record = Literal["goals", "always", "never"]
"""While goals run, always, or never."""


BAG_FOLDER = "bag"


class RunRecord(Config):
    """The file `run.yaml`."""

    cell: str
    started: datetime
    seed: int | None = None
    preset: str = ""
    command: str = ""
    commit: str
    versions: dict[str, str]
    configuration: dict[str, Any]

    def save(self, folder: Path) -> None:
        """Write `run.yaml` into the run's folder."""
        text = yaml.safe_dump(self.model_dump(mode="json"), sort_keys=False, allow_unicode=True, width=110)
        (folder / RECORD).write_text(text)


def describe_run(cell: str, seed: int | None, command: str, now: datetime, preset: str = "") -> RunRecord:
    """The record of a run that starts `now`, with the configuration as it is on disk."""
    return RunRecord(
        cell=cell, started=now, seed=seed, preset=preset, command=command, commit=checked_out_commit(),
        versions=installed_versions(),
        configuration={str(path.relative_to(config_path())): load_yaml(path) for path in _config_files(cell)},
    )  # fmt: skip


def default_folder(cell: str, seed: int | None, now: datetime, preset: str = "") -> Path:
    """The run's folder below bags/: cell, date and, where given, preset and seed."""
    suffix = f"_{preset.replace('/', '_')}" if preset else ""
    suffix += "" if seed is None else f"_seed{seed}"
    return bags_path() / f"{cell}_{now:%Y%m%d_%H%M%S}{suffix}"


def _config_files(cell: str) -> list[Path]:
    own = [config_path(folder, f"{cell}.yaml") for folder in ("cells", "graphs")]
    nodes = [node.parameters_path for node in load_graph(cell).nodes]
    return [path for path in (*own, *nodes) if path.is_file()]
