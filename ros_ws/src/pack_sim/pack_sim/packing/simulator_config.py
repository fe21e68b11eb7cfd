"""Parameters of the simulated driver and its sensors."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import AT_ONCE, Config
from pack_sim.packing.contact_governor import ContactGovernorConfig
from pack_sim.packing.hand_over import HandOverConfig
from pack_sim.packing.mismatch import MismatchConfig
from pack_sim.packing.mocap import MocapConfig
from pack_sim.packing.wrench_sensor import WrenchSensorConfig


class SimulatorConfig(Config):
    """Parameters of the simulated driver, its sensors and its errors."""

    timestep: float = Field(default=0.001, gt=0, le=0.001, description="physics and joint controller [s]")
    watchdog: PositiveFloat = Field(default=0.1, description="age at which setpoints are stale [s]")
    governor: ContactGovernorConfig = ContactGovernorConfig()
    friction_compensation: NonNegativeFloat = Field(
        default=0.0, description="compensated friction of each joint, along its desired velocity [N m]"
    )
    torque_rate: PositiveFloat = Field(
        default=math.inf, description="fastest change of a joint's torque while setpoints are tracked [N m/s]"
    )
    contact_width: NonNegativeFloat = Field(
        default=0.0005,
        description="penetration over which a contact becomes firm [m]; 0: at first touch, as MuJoCo has it",
    )
    mocap: MocapConfig = MocapConfig()
    wrench_sensor: Annotated[WrenchSensorConfig, AT_ONCE] = WrenchSensorConfig()
    mismatch: MismatchConfig = MismatchConfig()
    hand_over: HandOverConfig = HandOverConfig()
