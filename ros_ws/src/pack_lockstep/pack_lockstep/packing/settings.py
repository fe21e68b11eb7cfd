"""Settings of a packing benchmark: method, optimizer, weights, conditions and scenes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from pydantic import model_validator

from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.goals import PackingMethod
from pack_core.packing.scene import Scene
from pack_core.packing.scene_file import load_scene
from pack_lockstep.packing.lockstep_config import LockstepConfig, load_preset, lockstep_config
from pack_mpc.controller import OptimizerName
from pack_mpc.cost.weights import load_weights
from pack_mpc.optimizers import OPTIMIZERS

MM = 1e3
"""Millimetres in a metre."""


class BenchmarkSettings(Config):
    """Settings that decide the results beside the seeds; None: as in config/nodes/packing/mpc.yaml."""

    method: PackingMethod = PackingMethod.PACK_IT_IN
    optimizer: OptimizerName | None = None
    weights: str | None = None
    preset: str = "ideal"
    container: tuple[float, float] | None = None
    """Inside lengths along x and y [m]; None: as configured."""
    blocked: bool = True
    """Whether generated scenes have no place at which the new object would stand without contact."""
    scene_dir: Path | None = None
    """Folder of scene files that are run instead of generated scenes."""

    @model_validator(mode="after")
    def _is_for_generated_scenes(self) -> Self:
        if self.scene_dir is not None and (self.container is not None or not self.blocked):
            given = "container" if self.container is not None else "no_blocked"
            raise ValueError(f"{given} beside scene_dir; allowed: one of them, scenes have containers")
        return self


@dataclass(frozen=True)
class PackingSetup:
    """Settings with everything that they refer to, ready to run and to send to other processes."""

    settings: BenchmarkSettings
    cell: PackingCell
    config: LockstepConfig

    @property
    def optimizer(self) -> str:
        """Name of the optimizer that plans."""
        return self.settings.optimizer or self.config.session.controller.optimizer

    @property
    def name(self) -> str:
        """Short name for tables: method, optimizer, weights, conditions."""
        s, session = self.settings, self.config.session
        parts = [s.method.value, self.optimizer, session.weights, s.preset]
        if not s.blocked:
            parts.append("any scene")
        if s.container is not None:
            parts.append("x".join(f"{MM * side:.0f}" for side in s.container) + "mm")
        if s.scene_dir is not None:
            parts.append(s.scene_dir.resolve().name)
        return " ".join(parts)

    def record(self) -> dict[str, Any]:
        """All settings as plain values, for the head of the results.

        What has no influence on the results is left out: threads, and the parameters of other optimizers.
        """
        session = self.config.session
        config = self.config.model_dump(mode="json")
        controller = config["session"]["controller"]
        for name in ("threads", *(OPTIMIZERS.keys() - {self.optimizer})):
            controller.pop(name)
        config["planner"].pop("threads")
        config["planner"].pop("arrangement")  # this and the next are parameters of another benchmark
        config["session"].pop("fill")
        cell = self.cell.model_dump(mode="json")
        if self.cell.perception is Perception.MOCAP:
            config["estimator"].pop("depth")
            cell.pop("depth")
            cell.pop("perception")
        return {
            "name": self.name, **self.settings.model_dump(mode="json"), "weights": session.weights,
            "optimizer": self.optimizer, "cell": cell,
            "config": config, "weight_set": load_weights(session.weights).model_dump(mode="json"),
        }  # fmt: skip


@dataclass(frozen=True)
class SceneJob:
    """A scene to run, generated from the seed if it is None; the seed is that of the noise as well."""

    name: str
    seed: int
    scene: Scene | None = None


def set_up(settings: BenchmarkSettings, threads: int) -> PackingSetup:
    """Read what the settings refer to.

    Raises:
        ConfigError: there is no such preset, weight set or optimizer.
        PackError: the optimizer needs a package that is not installed.
    """
    preset = load_preset(settings.preset)
    if settings.container is not None:
        preset = preset.over("cell", {"scene": {"container": {"size": list(settings.container)}}})
    controller: dict[str, Any] = {"threads": threads}
    if settings.optimizer is not None:
        controller["optimizer"] = settings.optimizer
    preset = preset.over("mpc", {"controller": controller}).over("planner", {"threads": threads})
    if settings.weights is not None:
        preset = preset.over("mpc", {"weights": settings.weights})
    setup = PackingSetup(settings, preset.packing_cell(), lockstep_config(preset))
    OPTIMIZERS[setup.optimizer].require()
    return setup


def scene_jobs(settings: BenchmarkSettings, seed: int, count: int) -> list[SceneJob]:
    """The scenes to run, the first with `seed`, each with the next.

    Raises:
        ConfigError: the folder has no scene files, or fewer than wanted, or one that cannot be used.
    """
    if settings.scene_dir is None:
        return [SceneJob(f"seed_{n}", n) for n in range(seed, seed + count)]
    cell = load_preset(settings.preset).packing_cell()
    if not settings.scene_dir.is_dir():
        raise ConfigError(f"{settings.scene_dir}: no such folder; allowed: one with scene files (*.yaml)")
    files = sorted(settings.scene_dir.glob("*.yaml"))
    if len(files) < count:
        what = f"{settings.scene_dir} has {len(files)} scene files (*.yaml), and {count} are wanted"
        raise ConfigError(f"{what}; give --scenes {len(files)}" if files else what)
    seeds = range(seed, seed + count)
    return [
        SceneJob(f"{path.stem}_seed{n}", n, load_scene(path, cell))
        for n, path in zip(seeds, files, strict=False)
    ]


def parse_size(text: str) -> tuple[float, float]:
    """Inside lengths of a container [m] from a text like `0.24x0.19`.

    Raises:
        ConfigError: the text is not of this form.
    """
    match = re.fullmatch(r"(\d*\.?\d+)x(\d*\.?\d+)", text)
    if match is None:
        raise ConfigError(f"container '{text}'; allowed: lengths along x and y in metres, as in 0.24x0.19")
    return float(match[1]), float(match[2])
