"""What a run of the palletizing cell is made of, from the nodes' own configuration."""

from __future__ import annotations

from pathlib import Path

from pack_bringup.palletizing.benchmark import Setup
from pack_bringup.palletizing.lockstep import PalletLockstepConfig
from pack_core.cells.palletizing import palletizing_cell
from pack_core.paths import bags_path
from pack_motion.tracking.config import motion_set
from pack_planner.layout.layout_planner import LayoutConfig
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.profile import profile_of


def set_up(*, profile: str, motion: str, vision: bool) -> Setup:
    """Read what a command refers to.

    Raises:
        ConfigError: there is no such profile or motion set.
    """
    profile_of(profile)
    motion_set(motion)
    config = PalletLockstepConfig(motion=motion, palletizer=PalletizerConfig(profile=profile), vision=vision)
    return Setup(palletizing_cell(), config, LayoutConfig())


def default_output(*, profile: str, motion: str, vision: bool) -> Path:
    """Where a benchmark's results are kept when no file is given."""
    sight = "vision" if vision else "noise"
    return bags_path() / "benchmarks" / f"palletizing_{profile}_{motion}_{sight}.jsonl"
