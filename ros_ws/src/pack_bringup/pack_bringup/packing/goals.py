"""Goals of the packing cell, one object or a container from a list, and their nodes' parameters."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pack_bringup.graph.graph import conditions, flat_parameters, yaml_line
from pack_bringup.job import Progress, recorder_parameters
from pack_core.config import merged
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell
from pack_core.packing.packing_list import PackingList, load_list, parse_list, supermarket_list

if TYPE_CHECKING:
    from pack_core.ros.contracts.contract import Contract


@dataclass(frozen=True)
class PackingGoal:
    """What to pack, and how.

    Attributes:
        seed: of the generated scene, the sensors' noise and the placement planner.
        scene: a scene file; None: a generated scene.
        method: pack_it_in, uninformed_pose or uninformed_physics.
    """

    seed: int = 0
    scene: Path | None = None
    method: str = "pack_it_in"
    cell: str = "packing"
    server: str = "mpc"

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import PackObject

        from pack_core.ros.contracts.packing import PACK_OBJECT

        return PACK_OBJECT, PackObject.Goal(method=self.method, seed=self.seed)

    def reset(self) -> tuple[Contract, Any]:
        """The service that puts the cell into the goal's scene, and its request."""
        from pack_interfaces.srv import ResetScene

        from pack_core.packing.scene_file import scene_text
        from pack_core.ros.contracts.packing import RESET

        text = "" if self.scene is None else scene_text(self.scene)
        return RESET, ResetScene.Request(scene=text, seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            feedback.stage,
            f"{feedback.stage:9} {feedback.elapsed:5.1f} s  distance {100 * feedback.distance:5.1f} cm  "
            f"MPC {feedback.iteration_ms:4.0f} ms  real-time factor {real_time_factor:4.2f}",
        )


def seeded_goal(seed: int) -> PackingGoal:
    """The goal of a run without choices: a generated scene."""
    return PackingGoal(seed=seed)


@dataclass(frozen=True)
class PackingFillGoal(PackingGoal):
    """What to pack one after the other.

    Attributes:
        list_text: text of the list.
    """

    list_text: str = ""

    def goal(self) -> tuple[Contract, Any]:
        """The action, and its goal."""
        from pack_interfaces.action import FillContainer

        from pack_core.ros.contracts.packing import FILL_CONTAINER

        return FILL_CONTAINER, FillContainer.Goal(list=self.list_text, seed=self.seed)

    def reset(self) -> tuple[Contract, Any]:
        """The service that empties the container and the pump, and its request."""
        from pack_interfaces.srv import ResetScene

        from pack_core.ros.contracts.packing import RESET

        return RESET, ResetScene.Request(scene=self.list_text, seed=self.seed)

    def progress(self, feedback: Any, real_time_factor: float) -> Progress:
        """Feedback of the action in words."""
        return Progress(
            f"{feedback.stage} {feedback.object}",
            f"{feedback.stage:9} {feedback.object:14} {feedback.elapsed:5.1f} s  packed {feedback.packed}, "
            f"{feedback.remaining} to come, {100 * feedback.base_area:3.0f} % of the base  real-time factor "
            f"{real_time_factor:4.2f}",
        )


def wanted_list(seed: int, given: Path | None, cell: PackingCell | None = None) -> PackingList:
    """The list of a file or, without one, objects that the seed draws from the catalogue.

    Args:
        seed: draws them.
        given: the file.
        cell: the cell that shall pack them; None: a running one, which checks them itself.

    Raises:
        ConfigError: the list cannot be used.
    """
    return supermarket_list(seed, cell) if given is None else load_list(given, cell)


def fill_goal(seed: int, given: Path | None) -> PackingGoal:
    """The goal of a list file or, without one, of the list that the seed draws; raises ConfigError."""
    return PackingFillGoal(seed, list_text=wanted_list(seed, given).to_yaml())


def given_goal(text: str, seed: int) -> PackingGoal:
    """The goal of a packing list's text.

    Raises:
        ConfigError: the list cannot be used.
    """
    parse_list(text, "the list")
    return PackingFillGoal(seed, list_text=text)


@dataclass(frozen=True)
class PackingJob(PackingGoal):
    """What to run.

    Attributes:
        folder: of the run; nodes.log, bag/, run.yaml and scene.yaml go there.
        real_time_factor: None: that of config/nodes/packing/sim.yaml.
        command: the command line, for run.yaml.
        preset: of config/presets/packing; empty: the configuration files as they are.
        calibration: of the depth cameras, made under this preset; None: none.
    """

    folder: Path = field(kw_only=True)
    real_time_factor: float | None = None
    command: str = ""
    preset: str = ""
    calibration: Path | None = None

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text."""
        sim = {"seed": str(self.seed)}
        if self.scene is not None:
            sim["scene"] = json.dumps(str(self.scene.resolve()))
        if self.real_time_factor is not None:
            sim["real_time_factor"] = str(float(self.real_time_factor))
        recorder = recorder_parameters(self, self.seed, self.command)
        return merged(
            conditions(self.cell, self.preset, self.calibration), {"sim": sim, "recorder": recorder}
        )


def seeded_job(
    seed: int, folder: Path, *, real_time_factor: float | None, preset: str, command: str
) -> PackingJob:
    """The job of a seed, as `pack_bringup.job.SeededJob` has it."""
    return PackingJob(seed, folder=folder, real_time_factor=real_time_factor, preset=preset, command=command)


START = "start.yaml"
"""Scene file, in the run's folder, with which the simulator begins: an empty container."""


@dataclass(frozen=True)
class PackingFillJob(PackingFillGoal, PackingJob):
    """What to run: the goal of a list, with the nodes that a job starts.

    Attributes:
        start: text of the scene with which the simulator begins.
    """

    start: str = ""

    def overrides(self) -> dict[str, dict[str, str]]:
        """Parameters by node, as YAML text; the scene is written for the simulator to read."""
        given = super().overrides()
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / START).write_text(self.start)
        return given


def packing_fill_job(
    seed: int, given: Path | None, *, folder: Path, preset: str, real_time_factor: float | None, command: str,
    calibration: Path | None = None,
) -> PackingFillJob:  # fmt: skip
    """The job for a list file or, without one, for objects drawn from the catalogue.

    Raises:
        ConfigError: the list cannot be used, or there is no such preset.
    """
    cell = cell_of(preset)
    listed = wanted_list(seed, given, cell)
    return PackingFillJob(
        seed, folder / START, folder=folder, preset=preset, list_text=listed.to_yaml(),
        start=listed.start(cell).to_yaml(), real_time_factor=real_time_factor, command=command,
        calibration=calibration,
    )  # fmt: skip


def cell_of(preset: str) -> PackingCell:
    """The cell under a preset, or as configured; raises ConfigError where there is no such preset."""
    from pack_lockstep.packing.lockstep_config import PackingPreset, load_preset

    return (load_preset(preset) if preset else PackingPreset()).packing_cell()


NODES = ("sim", "perception", "planner", "mpc")
RECORDER = "recorder"
"""Notes the preset's name in run.yaml."""


def preset_overrides(name: str) -> dict[str, dict[str, str]]:
    """What a preset changes, by node and parameter, as YAML text.

    Raises:
        ConfigError: there is no such preset, it changes what is not there, or no node can do it.
    """
    from pack_lockstep.packing.lockstep_config import load_preset, lockstep_config

    preset = load_preset(name)
    preset.packing_cell()
    lockstep_config(preset)
    facts = {"cell": yaml_line(yaml_line(preset.cell))} if preset.cell else {}
    nodes = {node: {**facts, **flat_parameters(getattr(preset, node))} for node in NODES}
    return {**nodes, RECORDER: {"preset": yaml_line(name)}}


def calibration_overrides(preset: str, file: Path) -> dict[str, dict[str, str]]:
    """What a calibration changes, by node and parameter, as YAML text.

    Args:
        preset: what the cell is like; empty: the configuration files as they are.
        file: what `pack calibrate packing` has written.

    Raises:
        ConfigError: the file cannot be read, was made under another preset, or is of other cameras.
    """
    from pack_core.packing.depth_calibration import load_depth_calibration
    from pack_lockstep.packing.lockstep_config import load_preset

    found = load_depth_calibration(file)
    if found.preset != preset:
        raise ConfigError(
            f"{file}: made under preset '{found.preset}', and this cell has {preset or 'none'}; "
            f"give --preset {found.preset}"
        )
    found.applied(load_preset(preset).packing_cell().depth)
    return {"perception": {"calibration": json.dumps(str(file.resolve()))}}
