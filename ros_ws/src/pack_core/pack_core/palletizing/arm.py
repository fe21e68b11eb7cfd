"""Kinematics of the palletizing cell's arm."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np

from pack_core.kinematics.chain import SerialChain, chain_from_model
from pack_core.kinematics.spherical_wrist import SphericalWrist
from pack_core.palletizing.cell import palletizing_cell
from pack_core.robots.kr210 import JOINTS, LIMITS, add_kr210
from pack_core.robots.surface_gripper import TOOL
from pack_core.rotations import Array


@dataclass(frozen=True)
class PalletArmKinematics:
    """Forward and inverse kinematics.

    Attributes:
        chain: forward kinematics up to the tool, in the world frame.
        inverse: of the same chain.
        home: joint positions at rest `(6,)` [rad].
        model: what both were read from: arm and tool alone, where the base nominally stands.
        spec: what the model was compiled from.
    """

    chain: SerialChain
    inverse: SphericalWrist
    home: Array
    model: mujoco.MjModel
    spec: mujoco.MjSpec


@cache
def arm_kinematics() -> PalletArmKinematics:
    """The arm as configured in `config/cells/palletizing.yaml`."""
    cell = palletizing_cell()
    spec = mujoco.MjSpec()
    cell.tool.add_to(add_kr210(spec, cell.arm.X_WB, visuals=False), visuals=False)
    model = spec.compile()
    chain = chain_from_model(model, JOINTS, TOOL)
    inverse = SphericalWrist(chain, LIMITS.lower, LIMITS.upper)
    return PalletArmKinematics(chain, inverse, np.array(cell.arm.home), model, spec)
