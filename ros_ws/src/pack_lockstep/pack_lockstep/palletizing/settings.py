"""Reads the settings of a lockstep run of the palletizing cell from the nodes' own configuration."""

from __future__ import annotations

from typing import TypeVar

from pydantic import BaseModel

from pack_core.config import Config
from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.preset import PalletizingPreset, palletizing_preset
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.palletizing.benchmark import PalletSetup
from pack_lockstep.palletizing.box_finder import BoxFinderConfig
from pack_lockstep.palletizing.stepped_cell import PalletLockstepConfig
from pack_motion.tracking.config import motion_set
from pack_perception.boxes.box_vision import VisionConfig
from pack_planner.layout.layout_planner import LayoutConfig
from pack_planner.layout.online_planner import OnlineConfig
from pack_sim.palletizing.arrivals import ArrivalConfig
from pack_sim.palletizing.crossings import visitors_of
from pack_sim.palletizing.overhead_camera import PalletCameraConfig
from pack_sim.palletizing.place_scanner import PlaceScannerConfig
from pack_sim.palletizing.simulator import PalletSimulatorConfig
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.shift_job import ShiftConfig
from pallet_fsm.states import profile_of

C = TypeVar("C", bound=BaseModel)


class PalletSensorParameters(Config):
    """The part of the simulator's parameters that is of camera and scanners."""

    camera: PalletCameraConfig = PalletCameraConfig()
    scanner: PlaceScannerConfig = PlaceScannerConfig()


class PalletMotionParameters(Config):
    """The part of the motion controller's parameters that decides how the arm moves."""

    parameters: str


class ArrivalParameters(Config):
    """The part of the simulator's parameters that says how boxes come in a shift."""

    arrivals: ArrivalConfig = ArrivalConfig()


class PlaceParameters(Config):
    """The part of the planner's parameters that says where boxes go whose sequence nobody knows."""

    online: OnlineConfig = OnlineConfig()


class ShiftParameters(Config):
    """The part of the machine's parameters that is of shifts."""

    shift: ShiftConfig = ShiftConfig()


CORES: dict[str, tuple[type[Config], ...]] = {
    "sim": (PalletSimulatorConfig, PalletSensorParameters, ArrivalParameters),
    "vision": (VisionConfig,),
    "layout": (LayoutConfig, PlaceParameters),
    "motion": (PalletMotionParameters,),
    "fsm": (PalletizerConfig, ShiftParameters),
}
"""Configuration classes of the cores of each node, whose parameters a preset may change."""


def checked_preset(name: str) -> PalletizingPreset:
    """The preset called `name`; raises ConfigError if there is none, or no core knows a parameter of it."""
    preset = palletizing_preset(name)
    for node, classes in CORES.items():
        known = [field for cls in classes for field in cls.model_fields]
        if unknown := sorted(set(getattr(preset, node)) - set(known)):
            raise ConfigError(
                f"{preset.place(node, unknown[0])}: '{node}' has no {', '.join(unknown)}; allowed: "
                f"{', '.join(known)}"
            )
    return preset


def preset_parameters(preset: PalletizingPreset, node: str, cls: type[C]) -> C:
    """A core's configuration: its node's parameter file with a preset's changes; raises ConfigError."""
    return load_parameters(f"palletizing/{node}", cls, getattr(preset, node), preset.layers(node))


def place_parameters(preset: str) -> OnlineConfig:
    """Where boxes of shifts go, as the nodes' configuration has it under a preset."""
    return preset_parameters(checked_preset(preset), "layout", PlaceParameters).online


def set_up(
    *, preset: str = "rigid", profile: str = "", motion: str = "", vision: bool = True, visitors: str = "",
    gap_mm: float | None = None, has_limits: bool | None = None,
) -> PalletSetup:  # fmt: skip
    """Read the settings that the options of a command refer to.

    Args:
        preset: what the cell is like, and what its nodes do.
        profile: blended or thesis; empty: as the preset has it.
        motion: a set of config/motion; empty: likewise.
        vision: whether boxes are found in pictures.
        visitors: who comes near the arm; empty: nobody.
        gap_mm: between neighbours; None: as the preset has it.
        has_limits: whether joints and grip have limits, as they have not in the thesis; None: likewise.

    Raises:
        ConfigError: there is no such profile, motion set, preset or visitor.
    """
    visitors_of(visitors, 0)
    given = checked_preset(preset)
    if profile:
        given = given.over("fsm", {"profile": profile})
    if motion:
        given = given.over("motion", {"parameters": motion})
    if has_limits is not None:
        given = given.over("sim", {"has_limits": has_limits})
    if gap_mm is not None:
        given = given.over("layout", {"separator": {"gap": 1e-3 * gap_mm}})
    config = _lockstep_config(given, vision=vision)
    profile_of(config.palletizer.profile)
    motion_set(config.motion)
    name = f"{config.palletizer.profile} {config.motion} {preset} {'vision' if vision else 'noise'}"
    name += (f" {visitors}" if visitors else "") + ("" if config.simulator.has_limits else " unlimited")
    layout = preset_parameters(given, "layout", LayoutConfig)
    return PalletSetup(name, palletizing_cell(preset), config, layout, visitors)


def _lockstep_config(preset: PalletizingPreset, *, vision: bool) -> PalletLockstepConfig:
    """The configuration of all nodes from `config/nodes`, with a preset's changes."""
    sensors = preset_parameters(preset, "sim", PalletSensorParameters)
    return PalletLockstepConfig(
        motion=preset_parameters(preset, "motion", PalletMotionParameters).parameters,
        palletizer=preset_parameters(preset, "fsm", PalletizerConfig),
        sight=BoxFinderConfig(
            by="vision" if vision else "noise",
            camera=sensors.camera,
            vision=preset_parameters(preset, "vision", VisionConfig),
        ),
        scanner=sensors.scanner,
        simulator=preset_parameters(preset, "sim", PalletSimulatorConfig),
    )
