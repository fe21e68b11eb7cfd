"""Parameters of the palletizing machine."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import NEXT_GOAL, Changeable, Config
from pallet_fsm.blended_moves import BlendedConfig
from pallet_fsm.feeder import FeederConfig
from pallet_fsm.mover import MoverConfig
from pallet_fsm.scans.look import ScanConfig
from pallet_fsm.second_look import SecondLookConfig
from pallet_fsm.thesis_config import ThesisConfig
from pallet_fsm.tool_poses import ToolPoseConfig


class PalletizerConfig(Config):
    """Parameters of the machine."""

    changeable: ClassVar[Changeable] = NEXT_GOAL

    profile: str = Field(default="blended", description="thesis or blended")
    tries: int = Field(default=3, ge=1, description="for each kind of fault and box")
    dwell: NonNegativeFloat = Field(default=0.3, description="for the vacuum to build up or break down [s]")
    grip_patience: PositiveFloat = Field(default=2.0, description="for the gripper to close or open [s]")
    poses: ToolPoseConfig = ToolPoseConfig()
    blended: BlendedConfig = BlendedConfig()
    thesis: ThesisConfig = ThesisConfig()
    feeder: FeederConfig = FeederConfig()
    second_look: SecondLookConfig = SecondLookConfig()
    scans: ScanConfig = ScanConfig()
    mover: MoverConfig = MoverConfig()
