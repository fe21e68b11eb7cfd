"""Reads the settings of a lockstep run of the palletizing cell from the nodes' own configuration."""

from __future__ import annotations

from pack_core.config import Config
from pack_core.palletizing.cell import palletizing_cell
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.palletizing.benchmark import PalletSetup
from pack_lockstep.palletizing.box_finder import BoxFinderConfig
from pack_lockstep.palletizing.lockstep import PalletLockstepConfig
from pack_motion.tracking.config import motion_set
from pack_perception.boxes.box_vision import VisionConfig
from pack_planner.layout.layout_planner import LayoutConfig
from pack_sim.palletizing.crossings import visitors_of
from pack_sim.palletizing.overhead_camera import PalletCameraConfig
from pack_sim.palletizing.place_scanner import PlaceScannerConfig
from pack_sim.palletizing.simulator import PalletSimulatorConfig
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.states import profile_of


class PalletSensorParameters(Config):
    """The part of the simulator's parameters that is of camera and scanners."""

    camera: PalletCameraConfig = PalletCameraConfig()
    scanner: PlaceScannerConfig = PlaceScannerConfig()


def set_up(
    *, profile: str, motion: str, preset: str, vision: bool, visitors: str = "",
    gap_mm: float | None = None, has_limits: bool = True,
) -> PalletSetup:  # fmt: skip
    """Read the settings that the options of a command refer to.

    Args:
        profile: blended or thesis.
        motion: a set of config/motion.
        preset: what the cell is like.
        vision: whether boxes are found in pictures.
        visitors: who comes near the arm; empty: nobody.
        gap_mm: between neighbours; by default that of the layout's parameters.
        has_limits: whether joints and grip have limits, as they have not in the thesis.

    Raises:
        ConfigError: there is no such profile, motion set, preset or visitor.
    """
    profile_of(profile)
    motion_set(motion)
    visitors_of(visitors, 0)
    sensors = load_parameters("palletizing/sim", PalletSensorParameters)
    machine = load_parameters("palletizing/fsm", PalletizerConfig).model_copy(update={"profile": profile})
    sight = BoxFinderConfig(
        by="vision" if vision else "noise",
        camera=sensors.camera,
        vision=load_parameters("palletizing/vision", VisionConfig),
    )
    config = PalletLockstepConfig(
        motion=motion, palletizer=machine, sight=sight, scanner=sensors.scanner,
        simulator=load_parameters("palletizing/sim", PalletSimulatorConfig).model_copy(
            update={"has_limits": has_limits}
        ),
    )  # fmt: skip
    name = f"{profile} {motion} {preset} {'vision' if vision else 'noise'}"
    name += (f" {visitors}" if visitors else "") + ("" if has_limits else " unlimited")
    layout = load_parameters("palletizing/layout", LayoutConfig)
    if gap_mm is not None:
        separator = layout.separator.model_copy(update={"gap": 1e-3 * gap_mm})
        layout = layout.model_copy(update={"separator": separator})
    return PalletSetup(name, palletizing_cell(preset), config, layout, visitors)
